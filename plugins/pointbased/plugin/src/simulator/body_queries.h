// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "simulator/simulated_world.h"

namespace pointbased {

/// Reads the state of bodies: their figures, fields, triangles and displacement.
class BodyQueries {
 public:
  using EachField = c3de_status(C3DE_CALL *)(void *visitor, const c3de_sim_field *field);

  explicit BodyQueries(SimulatedWorld &world) : world_(world) {}

  void bodyAt(std::uint64_t index, c3de_handle *out);
  void bodyInfo(c3de_handle body, c3de_sim_body_info *out);
  c3de_status enumFields(c3de_handle body, void *visitor, EachField each);
  void readField(c3de_handle body, std::uint32_t on, c3de_str name, c3de_mview out);
  void triangles(c3de_handle body, c3de_view *out);
  void displacement(const c3de_sim_grid *grid, double rim, float *out, float *gaps);
  /// m, as slices show it: the displacement by which the material has reached a position; 0 where there is no body.
  /// Waits for a step. Any thread.
  [[nodiscard]] Vec3 displacementAt(const Vec3 &position) const;
  /// Names for changes. Throw sdk::Error C3DE_E_STALE if there is none. Any thread.
  [[nodiscard]] ObjectName nameOfBody(std::uint64_t body) const;
  [[nodiscard]] ObjectName nameOfObstacle(std::uint64_t obstacle) const;
  /// Reads a body under the lock; false if the body no longer exists.
  bool readBody(std::uint64_t body, const std::function<void(const Body &)> &read) const;

 private:
  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
