// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>

#include "simulator/change_access.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// The parameters of the world, passed to the solver when they change.
class WorldParameters {
 public:
  explicit WorldParameters(SimulatedWorld &world) : world_(world) {}

  /// All of them or, with sdk::Error, none. The mutex of the world is held.
  void set(ChangeAccess access, std::span<const c3de_param_value> values);
  [[nodiscard]] ParameterValues values() const;
  /// The same values, without waiting for a step; null: none were set yet. Any thread.
  [[nodiscard]] std::shared_ptr<const ParameterValues> shown() const;
  /// Moves the walls outwards until a body is inside. The mutex of the world is held.
  void growBox(const BodyRecord &body);

 private:
  void show();

  mutable std::mutex shownMutex_;
  std::shared_ptr<const ParameterValues> shown_;
  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
