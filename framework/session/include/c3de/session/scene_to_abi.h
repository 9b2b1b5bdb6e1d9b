// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "c3de/abi/draft/iface/simulator.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The values as C structs; they borrow from the values.
[[nodiscard]] std::vector<c3de_param_value> toAbi(const std::vector<ParameterValue> &values);
[[nodiscard]] c3de_sim_region toAbi(const scene::SceneRegion &region);
[[nodiscard]] c3de_sim_motion toAbi(const scene::SceneMotion &motion);

/// Puts a c3de_sim_body or c3de_sim_obstacle where the scene wants it.
template <class T>
void place(T &out, const scene::ScenePlacement &placement) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.position_m[axis] = placement.position_m[axis];
    out.rotation_deg[axis] = placement.rotation_deg[axis];
  }
  out.scale = placement.scale;
}

/// What a scene says of one body in tables of their own, as arrays for c3de_sim_body. Borrows from scene and values.
class BodyTables {
 public:
  /// @param partValues  per part of the body: its parameters, checked
  BodyTables(const scene::SceneFile &scene, const scene::SceneBody &body,
             const std::vector<std::vector<ParameterValue>> &partValues);
  BodyTables(const BodyTables &) = delete;
  BodyTables &operator=(const BodyTables &) = delete;

  /// Fixes, loads, parts, refinements and the velocities at the start; `out` borrows from this.
  void fill(c3de_sim_body &out) const;

 private:
  const scene::SceneBody &body_;
  std::vector<c3de_sim_fix> fixes_;
  std::vector<c3de_sim_load> loads_;
  std::vector<c3de_sim_part> parts_;
  std::vector<c3de_sim_refinement> refinements_;
  std::vector<std::vector<c3de_param_value>> partValues_;
};

/// The line of the table that a simulator's message about a body begins with: "fix 2: …", "load 0: …" (numbers of the
/// scene), "part 1: …", "refinement 0: …" (numbers of the body).
[[nodiscard]] std::optional<int> sceneLineOf(const scene::SceneFile &scene, const scene::SceneBody &body,
                                             std::string_view message);

}  // namespace c3de::session
