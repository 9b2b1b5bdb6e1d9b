// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "c3de/abi/iface/contact.h"
#include "c3de/abi/iface/grasp.h"
#include "c3de/abi/iface/simulator.h"
#include "c3de/plugin_host/plugin_error.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The values as C structs, which borrow from `values`.
[[nodiscard]] std::vector<c3de_param_value> toAbi(const std::vector<ParameterValue> &values);
[[nodiscard]] c3de_sim_region toAbi(const scene::SceneRegion &region);
[[nodiscard]] c3de_sim_motion toAbi(const scene::SceneMotion &motion);

[[nodiscard]] std::vector<c3de_sim_tool_place> toAbi(const std::vector<scene::SceneToolWaypoint> &path);
/// @param path  of the tool; borrowed, as is its name
[[nodiscard]] c3de_sim_probe_tool toAbi(const scene::SceneProbeTool &tool,
                                        const std::vector<c3de_sim_tool_place> &path);

[[nodiscard]] std::vector<c3de_sim_grasp_place> toAbi(const std::vector<scene::SceneGraspWaypoint> &path);
/// @param path  of the grasp; borrowed, as is its name. The caller sets the body
[[nodiscard]] c3de_sim_grasp toAbi(const scene::SceneGrasp &grasp, const std::vector<c3de_sim_grasp_place> &path);

[[nodiscard]] c3de_sim_placement toAbi(const scene::ScenePlacement &placement);
/// The grid of a fill in metres, for a simulator.
[[nodiscard]] c3de_sim_grid toAbi(const imaging::VolumeGeometry &grid);

/// The tables that a scene holds for one body, as arrays for c3de_sim_body. Borrows from scene and values.
class BodyTables {
 public:
  /// @param partValues  the checked parameters of each part of the body
  BodyTables(const scene::SceneFile &scene, const scene::SceneBody &body,
             const std::vector<std::vector<ParameterValue>> &partValues);
  BodyTables(const BodyTables &) = delete;
  BodyTables &operator=(const BodyTables &) = delete;

  /// Fixes, loads, parts, refinements and the initial velocities; `out` borrows from this object.
  void fill(c3de_sim_body &out) const;

 private:
  const c3de_sim_region *keep(const scene::SceneRegion &region);

  const scene::SceneBody &body_;
  std::deque<c3de_sim_region> regions_;  // a deque: addresses stay valid while elements are added
  std::deque<c3de_sim_grid> grids_;
  std::deque<c3de_sim_fill> fills_;
  std::deque<c3de_sim_motion> motions_;
  std::vector<c3de_sim_fix> fixes_;
  std::vector<c3de_sim_load> loads_;
  std::vector<c3de_sim_part> parts_;
  std::vector<c3de_sim_refinement> refinements_;
  std::vector<std::vector<c3de_param_value>> partValues_;
};

/// The scene line that a simulator error refers to: a fix or load by its number in the scene, a part or refinement by
/// its number in the body.
[[nodiscard]] std::optional<int> sceneLineOf(const scene::SceneFile &scene, const scene::SceneBody &body,
                                             const plugin_host::PluginError &error);

}  // namespace c3de::session
