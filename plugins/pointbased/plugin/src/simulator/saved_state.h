// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/sdk/scene_record.hpp"
#include "simulator/external_forces.h"
#include "simulator/grasps.h"
#include "simulator/holds.h"
#include "simulator/obstacles.h"

namespace pointbased {

/// The state of a simulation as bytes, with a record of the scene to which it belongs and with what acts on it
/// interactively.
class SavedState {
 public:
  SavedState(SimulatedWorld &world, ExternalForces &forces, SurfaceConditions &conditions, Holds &holds, Grasps &grasps,
             Obstacles &obstacles)
      : world_(world), forces_(forces), conditions_(conditions), holds_(holds), grasps_(grasps), obstacles_(obstacles) {
  }

  /// The mutex of the world is held.
  [[nodiscard]] std::string bytes(ChangeAccess);
  void load(const void *bytes, std::uint64_t n);

 private:
  [[nodiscard]] sdk::SceneRecord sceneRecord() const;
  /// Reads interactions from the front of the bytes. States of earlier versions have none.
  [[nodiscard]] static SavedInteractions takeInteractions(std::string_view &bytes);

  SimulatedWorld &world_;
  ExternalForces &forces_;
  SurfaceConditions &conditions_;
  Holds &holds_;
  Grasps &grasps_;
  Obstacles &obstacles_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
