// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/attachments.h"

namespace pointbased {

/// An obstacle that has been removed, with its associated data. Accessed on the simulation's thread.
struct RemovedObstacle {
  std::uint64_t id = 0;
  std::optional<ObstacleRecord> record = {};  ///< none: the obstacle is present
  Obstacle obstacle = {};                     ///< with the motion that a reset assigns to it
  RigidMotion pose = {};                      ///< its pose when it was removed
  ContactPairs pairs = {};
  std::vector<Attachment> attachments = {};
};

/// Obstacles of the scene, those that are added, moved and removed interactively, and the interactive instrument.
class Obstacles {
 public:
  Obstacles(SimulatedWorld &world, Attachments &attachments) : world_(world), attachments_(attachments) {}

  void add(const c3de_sim_obstacle *obstacle, c3de_handle *out);
  /// The interactive instrument: appears at the first position of its path and replaces the previous one. The simulated
  /// state is kept. Throws errors of obstacleOf() as sdk::Error. [sim]
  void placeInstrument(ProbeTool tool);
  /// Moves its middle to another position, m; does nothing if there is none. [sim]
  void moveInstrument(const Vec3 &middle);
  void removeInstrument();
  /// Moves an obstacle or the instrument to another pose, no faster than contact can follow. [sim]
  void guide(std::uint64_t obstacle, const RigidMotion &target);
  /// Removes the obstacle of this id, as remove() of iface.simulator does; does nothing if there is none. [sim]
  void extractObstacle(RemovedObstacle &obstacle);
  /// Restores it where it was, under another id, with its contact pairs and its attachments. The simulated state is
  /// kept, unless there were attachments or skin is now where the obstacle was: then the simulation is reset. Does
  /// nothing if the obstacle is present. [sim] @return whether the simulation has been reset
  bool reinsertObstacle(RemovedObstacle &obstacle);
  /// A new obstacle, with the default friction. Throws sdk::Error. Any thread.
  [[nodiscard]] RemovedObstacle prepare(const std::string &name, c3de_handle mesh, const Placement &placement);

 private:
  void eraseInstruments();
  void guideWithSpeedLimit(std::uint64_t obstacle, const RigidMotion &target);

  SimulatedWorld &world_;
  Attachments &attachments_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
};

}  // namespace pointbased
