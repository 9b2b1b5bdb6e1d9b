// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/scene_record.hpp"
#include "simulator/external_forces.h"
#include "simulator/holds.h"

namespace pointbased {

/// The state of a simulation as bytes, with a record of the scene to which it belongs.
class SavedState {
 public:
  SavedState(SimulatedWorld &world, ExternalForces &forces, Holds &holds)
      : world_(world), forces_(forces), holds_(holds) {}

  /// The mutex of the world is held.
  [[nodiscard]] std::string bytes(ChangeAccess);
  void load(const void *bytes, std::uint64_t n);

 private:
  [[nodiscard]] sdk::SceneRecord sceneRecord() const;

  SimulatedWorld &world_;
  ExternalForces &forces_;
  Holds &holds_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
