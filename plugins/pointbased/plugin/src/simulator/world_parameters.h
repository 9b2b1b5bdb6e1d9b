// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/simulated_world.h"

namespace pointbased {

/// The parameters of the world, passed to the solver when they change.
class WorldParameters {
 public:
  explicit WorldParameters(SimulatedWorld &world) : world_(world) {}

  void set(const c3de_param_value *values, std::uint64_t n, std::uint64_t stride);
  [[nodiscard]] ParameterValues values() const;
  /// Moves the walls outwards until a body is inside. The mutex of the world is held.
  void growBox(const BodyRecord &body);

 private:
  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
