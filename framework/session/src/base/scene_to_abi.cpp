// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/scene_to_abi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "c3de/core/text.h"
#include "c3de/scene/simulation.h"

namespace c3de::session {
namespace {

void copy(double (&out)[3], const Vec3 &in) {
  for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = in[axis];
}

}  // namespace

std::vector<c3de_param_value> toAbi(const std::vector<ParameterValue> &values) {
  std::vector<c3de_param_value> out;
  for (const ParameterValue &value : values) out.push_back(value.abi());
  return out;
}

c3de_sim_region toAbi(const scene::SceneRegion &region) {
  c3de_sim_region out{};
  out.size = sizeof out;
  switch (region.kind) {
    case scene::SceneRegion::Kind::everywhere: out.kind = C3DE_SIM_REGION_EVERYWHERE; break;
    case scene::SceneRegion::Kind::box: out.kind = C3DE_SIM_REGION_BOX; break;
    case scene::SceneRegion::Kind::sphere: out.kind = C3DE_SIM_REGION_SPHERE; break;
    case scene::SceneRegion::Kind::halfSpace: out.kind = C3DE_SIM_REGION_HALF_SPACE; break;
    case scene::SceneRegion::Kind::voxels: out.kind = C3DE_SIM_REGION_FILL; break;
  }
  copy(out.a, region.a);
  copy(out.b, region.b);
  out.radius = region.radius;
  return out;
}

c3de_sim_motion toAbi(const scene::SceneMotion &motion) {
  c3de_sim_motion out{};
  out.size = sizeof out;
  out.flags = (motion.centre_m ? C3DE_SIM_HAS_CENTRE : 0u) | (motion.quaternion ? C3DE_SIM_HAS_QUATERNION : 0u);
  if (motion.quaternion) std::copy(motion.quaternion->begin(), motion.quaternion->end(), out.quaternion);
  copy(out.displacement_m, motion.displacement_m);
  copy(out.rotation_deg, motion.rotation_deg);
  copy(out.centre_m, motion.centre_m.value_or(Vec3{}));
  out.ramp_s = motion.ramp_s;
  return out;
}

c3de_sim_placement toAbi(const scene::ScenePlacement &placement) {
  c3de_sim_placement out{};
  out.size = sizeof out;
  copy(out.position_m, placement.position_m);
  copy(out.rotation_deg, placement.rotation_deg);
  out.scale = placement.scale;
  if (placement.matrix) {
    out.flags = C3DE_SIM_PLACED_BY_MATRIX;
    std::copy(placement.matrix->begin(), placement.matrix->end(), out.matrix);
  }
  return out;
}

c3de_sim_grid toAbi(const imaging::VolumeGeometry &grid) {
  c3de_sim_grid out{};
  out.size = sizeof out;
  const Mat4 &m = grid.indexToWorld;
  for (std::size_t a = 0; a < 3; ++a) {
    out.points[a] = grid.size[a];
    out.step_i_m[a] = m[a] / scene::kMillimetresPerMetre;
    out.step_j_m[a] = m[4 + a] / scene::kMillimetresPerMetre;
    out.step_k_m[a] = m[8 + a] / scene::kMillimetresPerMetre;
    out.origin_m[a] = m[12 + a] / scene::kMillimetresPerMetre;
  }
  return out;
}

std::vector<c3de_sim_tool_place> toAbi(const std::vector<scene::SceneToolWaypoint> &path) {
  std::vector<c3de_sim_tool_place> out;
  for (const scene::SceneToolWaypoint &waypoint : path) {
    c3de_sim_tool_place one{};
    one.size = sizeof one;
    one.flags = waypoint.axis ? C3DE_SIM_PLACE_HAS_AXIS : 0u;
    one.time_s = waypoint.time_s;
    copy(one.at_m, waypoint.at_m);
    copy(one.axis, waypoint.axis.value_or(Vec3{}));
    out.push_back(one);
  }
  return out;
}

c3de_sim_probe_tool toAbi(const scene::SceneProbeTool &tool, const std::vector<c3de_sim_tool_place> &path) {
  c3de_sim_probe_tool out{};
  out.size = sizeof out;
  out.path_stride = sizeof(c3de_sim_tool_place);
  out.name = c3de::toAbi(tool.name);
  out.radius_m = tool.radius_m;
  out.length_m = tool.length_m;
  out.friction = tool.friction;
  out.path = path.data();
  out.path_n = path.size();
  return out;
}

std::vector<c3de_sim_grasp_place> toAbi(const std::vector<scene::SceneGraspWaypoint> &path) {
  std::vector<c3de_sim_grasp_place> out;
  for (const scene::SceneGraspWaypoint &waypoint : path) {
    c3de_sim_grasp_place one{};
    one.size = sizeof one;
    one.time_s = waypoint.time_s;
    copy(one.at_m, waypoint.at_m);
    // About x, then y, then z.
    std::array<double, 3> c{}, s{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double half = waypoint.turn_deg[axis] * std::numbers::pi / 360.0;
      c[axis] = std::cos(half);
      s[axis] = std::sin(half);
    }
    one.quaternion[0] = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
    one.quaternion[1] = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
    one.quaternion[2] = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
    one.quaternion[3] = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
    out.push_back(one);
  }
  return out;
}

c3de_sim_grasp toAbi(const scene::SceneGrasp &grasp, const std::vector<c3de_sim_grasp_place> &path) {
  c3de_sim_grasp out{};
  out.size = sizeof out;
  out.path_stride = sizeof(c3de_sim_grasp_place);
  out.name = c3de::toAbi(grasp.name);
  copy(out.at_m, grasp.at_m);
  copy(out.axis, grasp.axis);
  out.jaw_m = grasp.jaw_m;
  out.opening_m = grasp.opening_m();
  out.closed_m = grasp.closed_m();
  out.force_limit_N = grasp.forceLimit_N;
  out.path = path.data();
  out.path_n = path.size();
  return out;
}

const c3de_sim_region *BodyTables::keep(const scene::SceneRegion &region) {
  c3de_sim_region &out = regions_.emplace_back(toAbi(region));
  if (region.voxels) {
    const c3de_sim_grid &grid = grids_.emplace_back(toAbi(region.voxels->geometry));
    out.fill = &fills_.emplace_back(c3de_sim_fill{sizeof(c3de_sim_fill), 0, &grid, region.voxels->values.data()});
  }
  return &out;
}

BodyTables::BodyTables(const scene::SceneFile &scene, const scene::SceneBody &body,
                       const std::vector<std::vector<ParameterValue>> &partValues)
    : body_(body) {
  for (std::size_t i = 0; i < scene.fixes.size(); ++i) {
    const scene::SceneFix &fix = scene.fixes[i];
    if (fix.body != body.name) continue;
    c3de_sim_fix out{};
    out.size = sizeof out;
    out.index = static_cast<std::uint32_t>(i);
    out.name = c3de::toAbi(fix.name);
    out.region = keep(fix.region);
    out.motion = &motions_.emplace_back(toAbi(fix.motion));
    fixes_.push_back(out);
  }
  if (body.rigidTissue) {
    scene::SceneRegion region;
    region.kind = scene::SceneRegion::Kind::voxels;
    region.voxels = body.rigidTissue;
    c3de_sim_fix out{};
    out.size = sizeof out;
    out.index = static_cast<std::uint32_t>(scene.fixes.size());
    out.name = c3de::toAbi(std::string_view("rigid tissue"));
    out.region = keep(region);
    fixes_.push_back(out);
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const scene::SceneLoad &load = scene.loads[i];
    if (load.body != body.name) continue;
    c3de_sim_load out{};
    out.size = sizeof out;
    out.flags = (load.pressure_Pa ? C3DE_SIM_LOAD_PRESSURE : 0u) | (load.follower ? 0u : C3DE_SIM_LOAD_DEAD);
    out.index = static_cast<std::uint32_t>(i);
    out.name = c3de::toAbi(load.name);
    out.region = keep(load.region);
    copy(out.force_N, load.force_N.value_or(Vec3{}));
    out.pressure_Pa = load.pressure_Pa.value_or(0.0);
    out.ramp_s = load.ramp_s;
    loads_.push_back(out);
  }
  for (const std::vector<ParameterValue> &values : partValues) partValues_.push_back(toAbi(values));
  for (std::size_t i = 0; i < body.parts.size(); ++i) {
    c3de_sim_part out{};
    out.size = sizeof out;
    out.params_stride = sizeof(c3de_param_value);
    out.region = keep(body.parts[i].region);
    out.params = partValues_[i].data();
    out.params_n = partValues_[i].size();
    out.name = c3de::toAbi(body.parts[i].name);
    parts_.push_back(out);
  }
  for (const scene::SceneRefinement &refinement : body.refinements) {
    c3de_sim_refinement out{};
    out.size = sizeof out;
    out.region = keep(refinement.region);
    out.spacing_m = refinement.spacing_m;
    refinements_.push_back(out);
  }
}

void BodyTables::fill(c3de_sim_body &out) const {
  const auto assignRows = [](const auto &rows, auto &pointer, std::uint64_t &n, std::uint64_t &stride) {
    pointer = rows.empty() ? nullptr : rows.data();
    n = rows.size();
    stride = sizeof rows.front();
  };
  assignRows(fixes_, out.fixes, out.fixes_n, out.fixes_stride);
  assignRows(loads_, out.loads, out.loads_n, out.loads_stride);
  assignRows(parts_, out.parts, out.parts_n, out.parts_stride);
  assignRows(refinements_, out.refinements, out.refinements_n, out.refinements_stride);
  copy(out.velocity_m_s, body_.velocity_m_s);
  copy(out.angular_velocity_rad_s, body_.angularVelocity_rad_s);
}

std::optional<int> sceneLineOf(const scene::SceneFile &scene, const scene::SceneBody &body,
                               const plugin_host::PluginError &error) {
  const auto lineOf = [&](const auto &tables) -> std::optional<int> {
    if (error.index >= tables.size()) return std::nullopt;
    return tables[error.index].line;
  };
  if (error.table == "fix") return lineOf(scene.fixes);
  if (error.table == "load") return lineOf(scene.loads);
  if (error.table == "part") return lineOf(body.parts);
  if (error.table == "refinement") return lineOf(body.refinements);
  return std::nullopt;
}

}  // namespace c3de::session
