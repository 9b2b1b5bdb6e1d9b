// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/step_composition.h"
#include "pointbased/stop_request.h"
#include "pointbased/world_settings.h"

namespace pointbased {

class World;
namespace detail {
class Island;
class IslandScheduler;
class StepMonitor;
struct SimulationState;
struct StepContext;
}  // namespace detail

/// The reason why no step was made: every body that could move has stopped, or the step was cancelled.
struct StepFailure {
  std::string text;      ///< body, phyxel, quantity, and the setting that would help
  bool ended = false;    ///< by the stop request; the state is that before the step
  std::size_t body = 0;  ///< being computed at that time; 0: none
};

/// Makes the steps: bodies that may touch each other or are attached advance together as islands, the others
/// separately. Also what acts on bodies during steps from outside, and what a step of a body consists of.
class Stepper {
 public:
  Stepper(detail::SimulationState &state, const World &world);
  ~Stepper();

  /// Makes one step of the present size. Explicit: in the substeps that stability requires, at most 10 000; if these
  /// are not enough, time advances by what they cover. Refused if every body has stopped. Quasi-static: one load
  /// increment; no effect if finished().
  /// @param stop  null, or a request that cancels the step within a fraction of a second when it is raised. Every body
  ///              is then in its state before the step. Another thread may raise it.
  [[nodiscard]] tl::expected<void, StepFailure> step(const StopRequest *stop = nullptr);
  /// s, of the next step: WorldSettings::dt, or the longest that any body would choose; 0 for a quasi-static solution.
  [[nodiscard]] double stepSize() const;
  /// s, step of one body; for explicit integration the size of its substeps at rest. 0: static body or quasi-static
  /// solution.
  [[nodiscard]] double stepSizeOf(std::size_t body) const;
  /// True if every body that is not static has stopped.
  [[nodiscard]] bool failed() const;
  [[nodiscard]] std::size_t stoppedBodies() const;

  /// The integrator of a body: that of the world, or the one that is used in its place.
  [[nodiscard]] Integrator integratorOf(std::size_t body) const;
  /// Stages that a step of the body has now, with reasons. The next step uses the same decisions.
  [[nodiscard]] StepComposition compositionOf(std::size_t body) const;
  /// Force evaluations per simulated second: (explicit, implicit). The basis of Integrator::automatic.
  [[nodiscard]] std::pair<double, double> predictedCost(std::size_t body) const;
  /// Explains a cancelled step in sentences: how far it had advanced, and which settings would fit the time budget.
  /// Times an evaluation of the forces of that body, which costs as much as two of them.
  /// @param budget  s of wall-clock time for a step
  [[nodiscard]] std::string suggestAffordableStep(const StepFailure &ended, double budget);

  /// The body is at rest and costs nothing (WorldSettings::sleep): no stage runs, its state is constant bit for bit,
  /// its velocities are 0. A grab, a moving obstacle, or a change of material, world or scene wakes it.
  [[nodiscard]] bool asleep(std::size_t body) const;
  /// Call after changing the state of a body from outside: counts the change and wakes the body. Velocities other than
  /// 0 wake it automatically.
  void wake(std::size_t body);
  /// Increases changes() without waking the body: for a temporary change that is undone before the next step.
  void countChange(std::size_t body);
  /// Counter that grows whenever the state of a body may have changed, so that derived values can be cached.
  [[nodiscard]] std::uint64_t changes(std::size_t body) const;

  /// Sets external forces on the phyxels of a body (Body::swapExternalForces), from the next step until they are set
  /// again; wakes it. No effect on a static body (Body::isStatic()).
  void setExternalForces(std::size_t body, std::span<const Vec3> forces);
  void swapExternalForces(std::size_t body, std::vector<Vec3> &forces);
  /// A quasi-static solution that is finished solves its last increment again with the next step, because supports or
  /// external forces have changed. No effect on others.
  void repeatLastIncrement();
  /// Grabs a body from the next step until it is released or the simulation is reset. A grab with the same id is
  /// replaced. No effect on a static body.
  /// @param grabId  of the user's choice; a body may have several
  void setGrab(std::size_t body, Grab grab, std::uint64_t grabId = 0);
  void moveGrab(std::size_t body, const Vec3 &target, std::uint64_t grabId = 0);
  void turnGrab(std::size_t body, const Mat3 &rotation, std::uint64_t grabId = 0);
  void releaseGrab(std::size_t body, std::uint64_t grabId = 0);
  /// Empty if the body has no grab with this id.
  [[nodiscard]] std::optional<GrabStatus> grabStatus(std::size_t body, std::uint64_t grabId = 0) const;

 private:
  [[nodiscard]] Environment environment() const;
  [[nodiscard]] detail::StepContext context(const StopRequest *stop);
  [[nodiscard]] detail::StepContext contextFor(std::size_t body, const detail::StepContext &context) const;
  [[nodiscard]] std::vector<detail::StepContext> contextsOf(const detail::Island &island,
                                                            const detail::StepContext &context) const;
  /// Schedules the bodies that move in a step of dt; those that may touch each other in it as islands.
  detail::IslandScheduler &scheduleIslands(double dt);
  void buildIslands(double dt);
  [[nodiscard]] bool mayTouchItself(std::size_t body, double dt);
  /// Advances all bodies by dt. @return  s by which all have advanced; less if the substeps of a body were not enough
  double advanceBodies(const detail::StepContext &context);
  void increaseLoad(const detail::StepContext &context);
  /// Makes the present shape the reference of a body that has flowed far (rereferencing.h). False: not due, or not
  /// possible.
  /// @param stop  raised: postponed
  bool rereferenceIfNeeded(std::size_t body, const StopRequest *stop);

  detail::SimulationState &state_;
  const World &world_;
  std::unique_ptr<detail::StepMonitor> monitor_;
  std::unique_ptr<detail::IslandScheduler> scheduler_;  // scratch of a step
};

}  // namespace pointbased
