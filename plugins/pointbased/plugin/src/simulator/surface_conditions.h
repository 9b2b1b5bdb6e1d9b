// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "report/report.h"
#include "simulator/change_access.h"
#include "simulator/saved_interactions.h"
#include "simulator/simulated_world.h"

namespace pointbased {

/// Supports and loads on parts of surfaces, by number. They persist over a reset: supports then hold the points at
/// their reference, and ramps begin again. The mutex of the world is held in every call.
class SurfaceConditions {
 public:
  explicit SurfaceConditions(SimulatedWorld &world) : world_(world) {}

  /// Adds, replaces or, without a condition, removes one. Throws sdk::Error for what problemOf() refuses, for a patch
  /// that is not on the body, and for supports that prescribe different motions of the same surface.
  /// @param number  0: the next one is assigned
  void set(ChangeAccess access, std::uint64_t &number, const std::optional<SurfaceCondition> &condition);
  /// Follows resets, and bodies that were rebuilt or removed.
  void update();
  /// Adds the forces of the loads on a body, N. @param forces  [phyxels], or empty if there are none
  void addForces(std::uint64_t body, std::vector<Vec3> &forces) const;
  [[nodiscard]] bool loads(std::uint64_t body) const;
  void clear();
  [[nodiscard]] std::vector<ConditionSnapshot> snapshots() const;
  [[nodiscard]] std::vector<ReportedCondition> reported() const;
  [[nodiscard]] std::vector<SavedCondition> saved() const;
  /// Replaces all. Throws sdk::Error, with nothing changed, if a body is missing.
  void restore(const std::vector<SavedCondition> &saved);

 private:
  struct Live {
    SurfaceCondition what;
    SavedCondition::Start start = {};
    std::uint64_t body = 0;                      // id to which it is bound; 0: none
    std::shared_ptr<const RestState> rest = {};  // likewise
    Interpolation corners = {};                  // of the patch
    LoadedPart part = {};
    LiveSupport support = {};
    std::string warning = {};
  };
  [[nodiscard]] double now() const;
  [[nodiscard]] double progressOf(const Live &live) const;
  [[nodiscard]] Load presentLoad(const Live &live) const;
  [[nodiscard]] std::vector<Vec3> displacementsOf(const Live &live) const;
  void bind(Live &live) const;
  void checkPlace(const SurfaceCondition &condition) const;
  void checkOverlap(const SurfaceCondition &condition, std::uint64_t number) const;
  void applySupports(std::uint64_t body);

  SimulatedWorld &world_;
  Simulator &simulator_ = world_.simulator;
  BodyTable &table_ = world_.table;
  std::map<std::uint64_t, Live> all_;
  std::uint64_t lastNumber_ = 0, resets_ = 0;
};

}  // namespace pointbased
