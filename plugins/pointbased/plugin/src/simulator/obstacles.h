// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/attachments.h"
#include "simulator/change_kinds.h"
#include "simulator/saved_interactions.h"

namespace pointbased {

/// An obstacle that is not part of the simulation, with its associated data.
struct RemovedObstacle {
  std::uint64_t id = 0;  ///< that it had; 0: it has not been added yet
  ObstacleRecord record = {};
  Obstacle obstacle = {};  ///< with the motion that a reset assigns to it
  RigidMotion pose = {};   ///< its pose when it was removed
  ContactPairs pairs = {};
  std::vector<Attachment> attachments = {};
};

/// Obstacles of the scene, those that are added, moved and removed interactively, and the interactive instrument.
class Obstacles {
 public:
  Obstacles(SimulatedWorld &world, Attachments &attachments) : world_(world), attachments_(attachments) {}

  void add(const c3de_sim_obstacle *obstacle, c3de_handle *out);
  /// A new obstacle. Throws sdk::Error. Any thread.
  [[nodiscard]] RemovedObstacle build(const std::string &name, c3de_handle mesh, const Placement &placement,
                                      const ObstacleSurface &surface) const;

  // The mutex of the world is held.
  /// The interactive instrument: appears at the first position of its path and replaces the previous one. The simulated
  /// state is kept. Throws errors of obstacleOf() as sdk::Error.
  void placeInstrument(ChangeAccess access, ProbeTool tool);
  /// Moves its middle to another position, m; does nothing if there is none.
  void moveInstrument(ChangeAccess access, const Vec3 &middle);
  void removeInstrument(ChangeAccess) { eraseInstruments(); }
  /// Moves an obstacle or the instrument to another pose, no faster than contact can follow.
  void guide(ChangeAccess, std::uint64_t obstacle, const RigidMotion &target) { guideWithSpeedLimit(obstacle, target); }
  /// Adds an obstacle that was built. If skin is where it is, the simulation is reset; otherwise its state is kept.
  /// @return its id
  std::uint64_t addBuilt(ChangeAccess access, const RemovedObstacle &built);
  /// Removes an obstacle for restore().
  void remove(ChangeAccess access, std::uint64_t obstacle);
  /// Null if none of this name was removed.
  [[nodiscard]] const RemovedObstacle *removed(const ObjectName &name) const;
  /// Restores a removed obstacle under another id, with its contact pairs and its attachments. The simulation is reset
  /// if there were attachments or skin is now where the obstacle is; otherwise its state is kept.
  void restore(ChangeAccess access, const RestoreObstacle &what);
  void clear(ChangeAccess) { removed_.clear(); }
  [[nodiscard]] std::vector<SavedInstrument> savedInstruments() const;
  /// Instruments of a state that is to be loaded. Throws sdk::Error; nothing has changed then.
  struct RestoredInstruments {
    std::vector<ObstacleRecord> records;
    std::vector<Obstacle> obstacles;
  };
  [[nodiscard]] RestoredInstruments prepare(const std::vector<SavedInstrument> &saved) const;

 private:
  [[nodiscard]] std::pair<Obstacle, ObstacleRecord> instrumentOf(ProbeTool tool) const;
  std::uint64_t insert(const RemovedObstacle &what);
  void resetIfOverlapping(std::uint64_t obstacle, bool isAttached);
  void eraseInstruments();
  void guideWithSpeedLimit(std::uint64_t obstacle, const RigidMotion &target);

  SimulatedWorld &world_;
  Attachments &attachments_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<ObjectName, RemovedObstacle> removed_;
};

}  // namespace pointbased
