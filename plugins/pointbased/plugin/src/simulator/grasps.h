// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/report.h"
#include "simulator/simulated_world.h"
#include "simulator/snapshot.h"

namespace pointbased {

/// The state that an undo step of an interactive tool restores.
struct InteractionState {
  Checkpoint state;
  std::map<std::uint64_t, GraspRecord> grasps;
};

/// Pairs of jaws that hold bodies: those of a scene (iface.grasp) and the interactive ones.
class Grasps {
 public:
  explicit Grasps(SimulatedWorld &world) : world_(world) {}

  void add(const c3de_sim_grasp *grasp, c3de_handle *out);
  /// Interactive jaws grasp a body and replace the previous ones; does nothing if the body no longer exists.
  /// [sim]
  /// @param places  for which problemOf() is empty
  void begin(std::uint64_t body, const JawPositions &places, const GraspSettings &settings);
  /// Prescribed middle between the interactive jaws, m, and their rotation; does nothing if there are none. [sim]
  void move(const Vec3 &middle, const Mat3 &rotation);
  void release();
  /// The state before the pull that begins. [sim]
  [[nodiscard]] InteractionState checkpoint() const;
  /// Restores the stored state and stores the present one; does nothing if the simulation has been restarted since.
  /// [sim]
  void exchange(InteractionState &other);

  // The mutex of the world is held.
  /// Before a step: jaws of the scene start at their time, all close and move to their prescribed pose.
  void update();
  /// Removes the jaws themselves, also from the scene.
  void remove(std::uint64_t id);
  [[nodiscard]] std::vector<GraspSnapshot> snapshots() const;
  [[nodiscard]] std::vector<ReportedGrasp> reported() const;

 private:
  void setGrabs(std::uint64_t id, const Grasp &grasp);
  /// Nothing if it has lost what it held.
  [[nodiscard]] std::optional<GraspForces> forcesOn(std::uint64_t id, const Grasp &grasp) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, GraspRecord> &grasps_ = world_.grasps;
};

}  // namespace pointbased
