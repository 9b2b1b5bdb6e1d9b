// SPDX-License-Identifier: Apache-2.0
#include "simulator/body_source.h"

#include <Eigen/LU>
#include <cmath>

#include "c3de/sdk/structs.hpp"

namespace pointbased {
namespace {

using sdk::Error;

Vec3 vec(const double *v) { return {v[0], v[1], v[2]}; }

[[noreturn]] void refuse(const sdk::ErrorPlace &where, const std::string &what) {
  throw Error(C3DE_E_ARG, what, where);
}

sdk::ErrorPlace member(const char *key) { return {{}, 0, key}; }

Eigen::Quaterniond readQuaternion(const double *xyzw, const sdk::ErrorPlace &where) {
  const Eigen::Quaterniond q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  if (!q.coeffs().allFinite() || std::abs(q.norm() - 1.0) > 1e-6) refuse(where, "quaternion is not of unit length");
  return q.normalized();
}

/// rad, along the shorter rotation.
Vec3 rotationVectorOf(const double *xyzw, const sdk::ErrorPlace &where) {
  const Eigen::AngleAxisd turn(readQuaternion(xyzw, where));
  return turn.angle() * turn.axis();
}

void setMotion(const c3de_sim_motion *given, Fix &fix, const sdk::ErrorPlace &where) {
  if (given == nullptr) return;
  const c3de_sim_motion in = sdk::readStruct(given, "motion");
  fix.displacement = vec(in.displacement_m);
  if (in.flags & C3DE_SIM_HAS_QUATERNION)
    fix.rotationVector = rotationVectorOf(in.quaternion, where);
  else
    fix.rotation_deg = vec(in.rotation_deg);
  if (in.flags & C3DE_SIM_HAS_CENTRE) fix.centre = vec(in.centre_m);
  fix.ramp = in.ramp_s;
  if (!fix.displacement.allFinite() || !fix.rotation_deg.allFinite() || (fix.centre && !fix.centre->allFinite()))
    refuse(where, "displacement, rotation and centre have to be finite");
  if (!std::isfinite(fix.ramp) || fix.ramp < 0.0) refuse(where, "ramp is not finite and >= 0 s");
}

Load readLoad(const c3de_sim_load &in, const sdk::ErrorPlace &where) {
  Load load;
  load.region = readRegion(in.region, where);
  if (in.flags & C3DE_SIM_LOAD_PRESSURE)
    load.pressure = in.pressure_Pa;
  else
    load.force = vec(in.force_N);
  load.follower = !(in.flags & C3DE_SIM_LOAD_DEAD);
  load.ramp = in.ramp_s;
  if (!load.force.allFinite() || !std::isfinite(load.pressure)) refuse(where, "force or pressure is not finite");
  if (!std::isfinite(load.ramp) || load.ramp < 0.0) refuse(where, "ramp is not finite and >= 0 s");
  return load;
}

std::shared_ptr<const FillSource> readFill(const c3de_sim_fill &fill, const Placement &placement) {
  const c3de_sim_fill in = sdk::readStruct(&fill, "fill");
  if (in.grid == nullptr || in.values == nullptr) refuse(member("fill"), "grid or values is null");
  const FieldGrid grid = readGrid(*in.grid, "fill");
  const PlacementTransform transform(placement);
  const auto placed = [&](const Vec3 &metres) { return transform.metres(metres / kMetresPerMillimetre); };
  Occupancy occupancy;
  occupancy.size = grid.size;
  occupancy.origin = placed(grid.origin);
  for (int a = 0; a < 3; ++a) occupancy.steps.col(a) = placed(grid.origin + grid.steps.col(a)) - occupancy.origin;
  return std::make_shared<const FillSource>(std::vector<float>(in.values, in.values + grid.count()), occupancy);
}

}  // namespace

Region readRegion(const c3de_sim_region *given, const sdk::ErrorPlace &where, const Placement *placement) {
  if (given == nullptr) refuse(where, "region is null");
  const c3de_sim_region in = sdk::readStruct(given, "region");
  Region region;
  switch (in.kind) {
    case C3DE_SIM_REGION_EVERYWHERE: region = EverywhereRegion{}; break;
    case C3DE_SIM_REGION_BOX: region = BoxRegion{vec(in.a), vec(in.b)}; break;
    case C3DE_SIM_REGION_SPHERE: region = SphereRegion{vec(in.a), in.radius}; break;
    case C3DE_SIM_REGION_HALF_SPACE: region = HalfSpaceRegion{vec(in.a), vec(in.b)}; break;
    case C3DE_SIM_REGION_FILL: {
      if (in.fill == nullptr) refuse(where, "a region is a fill, and there is none");
      if (placement == nullptr) refuse(where, "a fill is accepted as the region of a part or a fix of a body alone");
      auto filled = regionOf(readFill(*in.fill, *placement)->occupancy);
      if (!filled) refuse(where, "the fill of a region: " + filled.error());
      region = std::move(*filled);
      break;
    }
    default: refuse(where, "region kind " + std::to_string(in.kind) + " is not known; accepted: 0 … 4");
  }
  if (const auto good = validate(region); !good) refuse(where, good.error());
  return region;
}

std::optional<Fix> readMotion(const c3de_sim_motion *motion, const char *what) {
  if (!motion) return std::nullopt;
  Fix fix;
  fix.region = EverywhereRegion{};
  setMotion(motion, fix, member(what));
  return fix;
}

BodySource readSource(const c3de_sim_body &body, const ParameterValues &values) {
  BodySource source;
  source.placement = readPlacement(body.placement);
  for (std::uint64_t i = 0; body.fixes && i < body.fixes_n; ++i) {
    const c3de_sim_fix in = sdk::readElement(body.fixes, i, body.fixes_stride, "fix");
    const sdk::ErrorPlace where{"fix", in.index, {}};
    Fix fix;
    fix.region = readRegion(in.region, where, &source.placement);
    setMotion(in.motion, fix, where);
    source.fixes.push_back(std::move(fix));
    source.fixNumbers.push_back(in.index);
    const std::string_view name = sdk::text(in.name);
    source.fixNames.push_back(name.empty() ? std::to_string(in.index) : std::string(name));
  }
  for (std::uint64_t i = 0; body.loads && i < body.loads_n; ++i) {
    const c3de_sim_load in = sdk::readElement(body.loads, i, body.loads_stride, "load");
    const sdk::ErrorPlace where{"load", in.index, {}};
    source.loads.push_back(readLoad(in, where));
    source.loadNumbers.push_back(in.index);
  }
  for (std::uint64_t i = 0; body.parts && i < body.parts_n; ++i) {
    const c3de_sim_part in = sdk::readElement(body.parts, i, body.parts_stride, "part");
    const sdk::ErrorPlace where{"part", static_cast<std::uint32_t>(i), {}};
    ParameterValues own = values;
    if (auto set = own.set(in.params, in.params_n, in.params_stride); !set) refuse(where, set.failure().message);
    std::vector<std::string> specified;
    for (std::uint64_t k = 0; k < in.params_n; ++k)
      specified.emplace_back(sdk::text(sdk::readElement(in.params, k, in.params_stride, "parameter").id));
    source.parts.push_back({std::string(sdk::text(in.name)), readRegion(in.region, where, &source.placement),
                            std::move(own), std::move(specified)});
  }
  std::vector<std::string> tissues;
  for (const BodyPart &part : source.parts) tissues.push_back(part.name);
  source.tissues = std::make_shared<const std::vector<std::string>>(std::move(tissues));
  for (std::uint64_t i = 0; body.refinements && i < body.refinements_n; ++i) {
    const c3de_sim_refinement in = sdk::readElement(body.refinements, i, body.refinements_stride, "refinement");
    const sdk::ErrorPlace where{"refinement", static_cast<std::uint32_t>(i), {}};
    if (!std::isfinite(in.spacing_m) || in.spacing_m <= 0.0) refuse(where, "spacing is not finite and > 0 m");
    source.refinements.push_back({readRegion(in.region, where), in.spacing_m});
  }
  source.velocity = vec(body.velocity_m_s);
  source.angularVelocity = vec(body.angular_velocity_rad_s);
  if (!source.velocity.allFinite() || !source.angularVelocity.allFinite())
    refuse(member("velocity"), "velocity and angular velocity have to be finite");
  if (body.colour != nullptr) {
    source.colour.emplace();
    for (std::size_t c = 0; c < 3; ++c) {
      (*source.colour)[c] = body.colour[c];
      if (!(body.colour[c] >= 0.0f && body.colour[c] <= 1.0f)) refuse(member("colour"), "is not in 0 ... 1");
    }
  }
  if (body.fill != nullptr) source.fill = readFill(*body.fill, source.placement);
  return source;
}

Load readLoad(const c3de_sim_load *load) {
  const c3de_sim_load in = sdk::readStruct(load, "load");
  return readLoad(in, {"load", in.index, {}});
}

Mat3 readRotation(const double *xyzw, const char *what) {
  return readQuaternion(xyzw, member(what)).toRotationMatrix();
}

FieldGrid readGrid(const c3de_sim_grid &grid, const char *what) {
  const c3de_sim_grid in = sdk::readStruct(&grid, "grid");
  FieldGrid out;
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (in.points[a] == 0 || in.points[a] > kMost / count)
      refuse(member(what),
             "has " + std::to_string(in.points[a]) + " points along an axis; accepted: 1 and more, 2^31 in all");
    count *= in.points[a];
    out.size[a] = static_cast<std::size_t>(in.points[a]);
  }
  out.origin = vec(in.origin_m);
  out.steps << vec(in.step_i_m), vec(in.step_j_m), vec(in.step_k_m);
  const double volume = std::abs(out.steps.determinant());
  if (!out.origin.allFinite() || !out.steps.allFinite() || !(volume > 0.0))
    refuse(member(what), "its steps have to span space");
  return out;
}

}  // namespace pointbased
