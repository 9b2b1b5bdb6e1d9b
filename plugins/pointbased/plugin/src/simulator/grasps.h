// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/report.h"
#include "simulator/change_access.h"
#include "simulator/saved_interactions.h"
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

  // The mutex of the world is held.
  /// Interactive jaws grasp a body and replace the previous ones.
  /// @param places  for which problemOf() is empty
  void begin(ChangeAccess access, std::uint64_t body, const JawPositions &places, const GraspSettings &settings);
  /// Prescribed middle between the interactive jaws, m, and their rotation; does nothing if there are none.
  void move(ChangeAccess access, const Vec3 &middle, const Mat3 &rotation);
  /// Removes the jaws themselves, also from the scene.
  void remove(ChangeAccess, std::uint64_t id) { erase(id); }
  void removeOf(ChangeAccess access, std::uint64_t body);
  /// The state before the pull that begins.
  [[nodiscard]] InteractionState checkpoint() const;
  /// Restores the stored state and stores the present one. False, with nothing changed, if the simulation has been
  /// restarted since.
  bool exchange(ChangeAccess access, InteractionState &other);
  [[nodiscard]] std::vector<SavedGrasp> saved() const;
  /// Ids of the grabs of those of a state that is to be loaded, by the ids in the state. Throws sdk::Error if one is
  /// not possible; nothing has changed then.
  [[nodiscard]] std::map<std::uint64_t, std::uint64_t> grabIds(const std::vector<SavedGrasp> &saved) const;
  /// Replaces the state of all jaws, after StateArchive::load() and with the grabs under the ids of grabIds().
  void restore(const std::vector<SavedGrasp> &saved);
  /// Before a step: jaws of the scene start at their time, all close and move to their prescribed pose.
  void update();
  [[nodiscard]] std::vector<GraspSnapshot> snapshots() const;
  [[nodiscard]] std::vector<ReportedGrasp> reported() const;

 private:
  void erase(std::uint64_t id);
  /// 0 if there are none of this name.
  [[nodiscard]] std::uint64_t jawsNamed(const std::string &name) const;
  void setGrabs(std::uint64_t id, const Grasp &grasp);
  /// Nothing if it has lost what it held.
  [[nodiscard]] std::optional<GraspForces> forcesOn(std::uint64_t id, const Grasp &grasp) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, GraspRecord> &grasps_ = world_.grasps;
};

}  // namespace pointbased
