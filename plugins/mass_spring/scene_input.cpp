// SPDX-License-Identifier: Apache-2.0
#include "scene_input.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "c3de/sdk/structs.hpp"

namespace mass_spring {
namespace {

using sdk::Error;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

}  // namespace

std::string shown(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

Placement readPlacement(const c3de_sim_placement *in) {
  Placement out;
  if (in == nullptr) return out;
  const auto p = sdk::readStruct(in, "placement");
  double scale = p.scale == 0.0 ? 1.0 : p.scale;
  if ((p.flags & C3DE_SIM_PLACED_BY_MATRIX) != 0) {
    for (std::size_t r = 0; r < 3; ++r) {
      out.linear[r] = {p.matrix[r], p.matrix[4 + r], p.matrix[8 + r]};
      out.position[r] = p.matrix[12 + r];
    }
    scale = length(out.linear[0]);
    const Vec3 third = cross(out.linear[0], out.linear[1]) - scale * out.linear[2];
    if (!(scale > 0.0) || !(length(third) < 1e-4 * scale * scale) ||
        !(std::abs(dot(out.linear[0], out.linear[1])) < 1e-4 * scale * scale))
      throw Error(C3DE_E_ARG, "matrix: accepted: a rotation times one scale above 0, and a displacement");
  } else {
    out.position = vectorOf(p.position_m);
    out.linear = rotationOf(kDegree * vectorOf(p.rotation_deg));
    for (Vec3 &row : out.linear) row = scale * row;
  }
  if (!(scale > 0.0) || !std::isfinite(scale) || !isFinite(out.position) || !isFinite(out.linear[0]))
    throw Error(C3DE_E_ARG, "position, rotation and scale must be finite, scale above 0");
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) out.inverse[r][c] = out.linear[c][r] / (scale * scale);
  return out;
}

bool contains(const c3de_sim_region &region, const Vec3 &x) {
  const Vec3 a = vectorOf(region.a), b = vectorOf(region.b);
  switch (region.kind) {
    case C3DE_SIM_REGION_EVERYWHERE: return true;
    case C3DE_SIM_REGION_BOX:
      return x[0] >= a[0] && x[1] >= a[1] && x[2] >= a[2] && x[0] <= b[0] && x[1] <= b[1] && x[2] <= b[2];
    case C3DE_SIM_REGION_SPHERE: return length(x - a) <= region.radius;
    case C3DE_SIM_REGION_HALF_SPACE: return dot(x - a, b) <= 0.0;
    default:
      throw Error(C3DE_E_ARG, "region: kind " + std::to_string(region.kind) + " is not known; accepted: 0 ... 3");
  }
}

Motion readMotion(const c3de_sim_motion *in, const Vec3 &middle, std::uint32_t index) {
  const auto m = sdk::readStruct(in, "motion");
  if ((m.flags & C3DE_SIM_HAS_QUATERNION) != 0)
    throw Error(C3DE_E_UNSUPPORTED, "quaternion: this simulator turns by angles; accepted: rotation_deg",
                {"fix", index, {}});
  Motion out{vectorOf(m.displacement_m), kDegree * vectorOf(m.rotation_deg),
             (m.flags & C3DE_SIM_HAS_CENTRE) != 0 ? vectorOf(m.centre_m) : middle, m.ramp_s};
  if (!isFinite(out.displacement_m) || !isFinite(out.rotation_rad) || !isFinite(out.centre_m) || !(out.ramp_s >= 0.0))
    throw Error(C3DE_E_ARG, "displacement, rotation and centre must be finite, the ramp at least 0 s",
                {"fix", index, {}});
  return out;
}

SurfaceLoad readLoad(const c3de_sim_load &in, const PointBody &body) {
  SurfaceLoad out;
  const auto region = sdk::readStruct(in.region, "region");
  const Surface &skin = body.skin();
  for (std::uint32_t t = 0; t < skin.triangles.size(); ++t) {
    const auto &[a, b, c] = skin.triangles[t];
    if (!contains(region, (1.0 / 3.0) * (skin.vertices[a] + skin.vertices[b] + skin.vertices[c]))) continue;
    out.triangles.push_back(t);
    out.area_m2 += 0.5 * length(cross(skin.vertices[b] - skin.vertices[a], skin.vertices[c] - skin.vertices[a]));
  }
  if (!(out.area_m2 > 0.0))
    throw Error(C3DE_E_ARG, "the region meets no middle of a triangle of the surface", {"load", in.index, {}});
  if ((in.flags & C3DE_SIM_LOAD_PRESSURE) != 0)
    out.pressure_Pa = in.pressure_Pa;
  else
    out.force_N = vectorOf(in.force_N);
  out.isDead = (in.flags & C3DE_SIM_LOAD_DEAD) != 0;
  out.ramp_s = in.ramp_s;
  if (!isFinite(out.force_N) || !std::isfinite(out.pressure_Pa) || !(out.ramp_s >= 0.0))
    throw Error(C3DE_E_ARG, "force and pressure must be finite, the ramp at least 0 s", {"load", in.index, {}});
  return out;
}

}  // namespace mass_spring
