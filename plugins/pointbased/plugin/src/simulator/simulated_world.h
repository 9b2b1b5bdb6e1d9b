// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "base/parameters.h"
#include "base/step_request.h"
#include "fields/evaluation_points.h"
#include "simulator/body_table.h"
#include "simulator/grasp_record.h"
#include "simulator/plugin_context.h"

namespace pointbased {

/// The data of a WorldSimulator that its parts share. The mutex serialises the solver's step and the additions and
/// reads of other threads; it guards the members below it, and is held in every call of this.
struct SimulatedWorld {
  explicit SimulatedWorld(PluginContext &of) : context(of), simulator(of.services.parallelFor()) {}

  /// Under a StateLock: returns to the initial state, with the jaws of the scene and without instruments.
  void reset();
  /// Ids of loads, holds and grasps, above those of bodies, obstacles and probes.
  [[nodiscard]] std::uint64_t allocateIds(std::uint64_t count);
  /// Stores the position of a grab for the trial of an adaptive sampling: the last eight positions of a body.
  void recordGrab(std::uint64_t body, const Grab &grab);
  /// Stores the pull of a grab likewise.
  void recordPull(std::uint64_t body, std::uint64_t grabId);
  /// Replaces the state of a body by another shape for display, for example an iteration of a match. Snapshots and
  /// fields contain it; StateLock restores the state, bit for bit. Stresses of bodies without vector kernels do not
  /// change. No effect if the body has another number of phyxels.
  void show(std::uint64_t body, std::span<const Vec3> displacements);
  struct BodyShape {
    std::uint64_t body = 0;
    std::vector<Vec3> displacements;  ///< empty: there is none
    [[nodiscard]] explicit operator bool() const { return !displacements.empty(); }
  };
  [[nodiscard]] bool isShowing() const { return static_cast<bool>(saved_); }
  /// Returns the shape that was shown.
  BodyShape restoreState();

  PluginContext &context;
  StepInterrupt request;
  std::mutex mutex;
  Simulator simulator;
  ParameterValues parameters{worldDeclarations()};
  BodyTable table;
  EvaluationPoints points;
  std::map<std::uint64_t, GraspRecord> grasps;
  std::uint64_t nextId = std::uint64_t{1} << 32;
  std::uint64_t resets = 0;  ///< number of resets so far

 private:
  BodyShape saved_;  // what show() has replaced
};

/// Locks the mutex of a world whose bodies have their states. Where only the mutex is locked, a body may have the shape
/// of SimulatedWorld::show().
class StateLock {
 public:
  enum class AtEnd { state, shape };  ///< shape: what was shown is shown again, after a read
  explicit StateLock(SimulatedWorld &world, AtEnd atEnd = AtEnd::state)
      : lock_(world.mutex), world_(world), shown_(world.restoreState()) {
    if (atEnd == AtEnd::state) shown_.displacements.clear();
  }
  ~StateLock() {
    if (shown_) world_.show(shown_.body, shown_.displacements);
  }
  StateLock(const StateLock &) = delete;
  StateLock &operator=(const StateLock &) = delete;

 private:
  std::lock_guard<std::mutex> lock_;
  SimulatedWorld &world_;
  SimulatedWorld::BodyShape shown_;
};

}  // namespace pointbased
