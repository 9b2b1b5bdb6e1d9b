// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/change_access.h"
#include "simulator/saved_interactions.h"
#include "simulator/simulated_world.h"
#include "simulator/surface_conditions.h"

namespace pointbased {

/// Forces and loads of other plugins on bodies while they are simulated.
class ExternalForces {
 public:
  explicit ExternalForces(SimulatedWorld &world) : world_(world) {}

  void points(c3de_handle body, c3de_sim_points *out);

  /// A load added while the body is simulated: acts as external forces.
  struct RuntimeLoad {
    std::uint64_t body = 0;
    Load load;
    LoadedPart part;
    std::shared_ptr<const RestState> rest;  ///< to which the part belongs
    double startTime_s = 0.0;
    std::uint64_t number = 0;
  };

  // The mutex of the world is held.
  /// @param number  by which it is found; 0: the next one is assigned
  /// @return its id
  std::uint64_t addLoad(ChangeAccess access, std::uint64_t body, const Load &load, std::uint64_t &number);
  /// 0 if there is none. @param id, number  of the load
  [[nodiscard]] std::uint64_t numberOf(std::uint64_t id) const;
  [[nodiscard]] std::uint64_t loadNumbered(std::uint64_t number) const;
  /// Before a step: sets the forces requested since the last step and those of the loads; other bodies have none.
  void apply(const SurfaceConditions &conditions);
  /// After a quasi-static step that finished: repeats its last increment if pressures that follow the surface differ on
  /// the new shape from those of the step by more than kFollowerTolerance. At most kMostRepetitions times.
  void continueToEquilibrium(const SurfaceConditions &conditions);
  /// Called after the masses of a body have changed.
  void invalidateMasses(std::uint64_t body);
  void removeLoad(ChangeAccess, std::uint64_t id) { loads_.erase(id); }
  void removeLoadsOf(ChangeAccess access, std::uint64_t body);
  void removeLoads() { loads_.clear(); }
  /// Forces that hold a body in a matched state, until the next reset. @param forces  [phyxels] N
  void setMatched(ChangeAccess, std::uint64_t body, std::vector<Vec3> forces);
  [[nodiscard]] std::vector<SavedLoad> saved() const;
  [[nodiscard]] std::vector<SavedMatch> savedMatches() const;
  /// Loads of a state to be loaded, for restore(). Throws sdk::Error; nothing has changed then.
  [[nodiscard]] std::vector<RuntimeLoad> prepare(const std::vector<SavedLoad> &saved) const;
  /// Replaces all loads.
  void restore(std::vector<RuntimeLoad> loads, const std::vector<SavedMatch> &matches);

 private:
  /// For bodies on which external forces act in the next step. Copies, because another thread may replace the body
  /// while they are being written.
  struct SharedPoints {
    std::vector<Vec3> positions, velocities, forces;
    std::vector<double> masses;             // empty: to be recomputed
    std::shared_ptr<const RestState> rest;  // to which the masses belong
    std::string name;
    bool isRequested = false;
  };
  void bind(RuntimeLoad &load) const;
  /// Adds the loads on a body at its present shape. @param forces  N, [phyxels], or empty: resized if there are any
  void addLoads(std::uint64_t body, const SurfaceConditions &conditions, std::vector<Vec3> &forces) const;

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, SharedPoints> sharedPoints_;
  std::map<std::uint64_t, RuntimeLoad> loads_;
  std::map<std::uint64_t, std::vector<Vec3>> matched_;  // by body, since the reset of this number
  std::uint64_t matchedResets_ = 0;
  std::uint64_t lastNumber_ = 0;
  int repetitions_ = 0;  // of the last increment, since the loads or supports changed
};

}  // namespace pointbased
