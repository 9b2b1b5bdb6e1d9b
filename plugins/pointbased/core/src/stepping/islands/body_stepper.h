// SPDX-License-Identifier: Apache-2.0
// Advances one body through the steps of its world. Private to the core.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "pointbased/world_settings.h"
#include "stepping/explicit/substep_controller.h"
#include "stepping/monitoring/guard.h"
#include "stepping/monitoring/sleep_detector.h"

namespace pointbased::detail {

/// One step of the world, as passed to its bodies.
struct StepContext {
  const WorldSettings &world;
  Environment environment;
  double time = 0.0;                                                           ///< s, at its beginning
  double dt = 0.0;                                                             ///< s, its size
  double loadFactor = 0.0;                                                     ///< reached so far; quasi-static
  std::uint64_t number = 1;                                                    ///< number of this step, starting at 1
  std::function<void(const char *kind, const std::string &text)> reportEvent;  ///< receives notable events
};

/// Advances one body and reports events.
///
/// Steps that the guard refuses are undone and retried with half the step size, down to 1/64 (crushed bodies: 1/4);
/// after successful steps the size increases again. Spurious energy may have been gained in any step since the last
/// energy check, so all of these are repeated, from the state of that check. If nothing helps, the body stops in the
/// last valid state.
class BodyStepper {
 public:
  explicit BodyStepper(std::unique_ptr<Body> body) : body_(std::move(body)) {}

  [[nodiscard]] Body &body() { return *body_; }
  [[nodiscard]] const Body &body() const { return *body_; }
  [[nodiscard]] bool stopped() const { return body_->stopped.has_value(); }
  /// The integrator of the world, or a suitable replacement (reported once).
  [[nodiscard]] Integrator integratorIn(const WorldSettings &world) const;
  /// Sets the integrator that it shares with the bodies it touches or is attached to; empty: it is integrated
  /// separately.
  void setSharedIntegrator(std::optional<Integrator> scheme) { sharedIntegrator_ = scheme; }
  [[nodiscard]] Integrator integratorNow(const WorldSettings &world) const {
    return sharedIntegrator_.value_or(integratorIn(world));
  }

  /// Advances by `span` within a step of context.dt.
  /// @param span  s, <= context.dt: the part of the step that another body has left
  /// @return  s by which it has advanced: less if the substeps of a step were not enough; `span` if it has stopped
  [[nodiscard]] double advance(const StepContext &context, double span);
  /// Repeats the last advance(), only as far as another body has advanced, in as many substeps as that requires.
  void advanceAgain(const StepContext &context, double span);
  /// Quasi-static: continues from context.loadFactor, in smaller increments if this one is too large.
  void loadUpTo(const StepContext &context, double factor);

  // Parts of advance(), for bodies that touch others and advance together with them (island.h):
  struct Refusal {
    GuardFinding finding;
    bool crushed = false;
  };
  using Advance = tl::expected<double, Refusal>;  // s
  /// Whether it remains asleep; wakes it if something has changed. Call once per step.
  [[nodiscard]] bool remainsAsleep(const StepContext &context, double span);
  void beginAdvance(const StepContext &context);
  /// Whether its state can be advanced, which is then stored; else it stops.
  [[nodiscard]] std::optional<QuickCheckResult> checkpointIfValid(const StepContext &context);
  /// Largest substep that the body can make now, s.
  [[nodiscard]] Advance maxSubstep(const StepContext &context, double time, double left, const QuickCheckResult *check);
  /// Returns to the state before the step and halves the steps of the next attempt.
  /// @param from  description of that state, for the event
  /// @return  false: it has stopped there instead, because smaller steps did not help
  [[nodiscard]] bool retryWithSmallerStep(const StepContext &context, const Refusal &refusal,
                                          const std::string &from = "before");
  /// Returns to the state before the step, because another body has to.
  void restoreStepStart(const ParallelFor &parallelFor);
  /// Call when the step is complete.
  void endAdvance();
  [[nodiscard]] SubstepController &substeps() { return substeps_; }
  void reportSubsteps(const StepContext &context, double span, double advanced, std::uint64_t substeps, double needed);
  /// Whether it has been at rest long enough to sleep.
  [[nodiscard]] bool isAtRest(const StepContext &context, double span);
  void fallAsleep();
  [[nodiscard]] std::uint64_t maxSubsteps() const;
  void reportIntegrator(const StepContext &context);
  /// Reports once that it makes explicit steps because it touches others.
  /// @param free  name of one of them that is rigid and moves freely; empty: there is none
  void reportShared(const StepContext &context, const std::string &names, const std::string &free);
  /// Present fraction of the usual step size, after failures.
  [[nodiscard]] double stepScale() const { return scale_; }
  /// Stops the body in its present state.
  void stop(const StepContext &context, const GuardFinding &finding);
  /// Call before load increments that may be cancelled.
  void beginLoad(const StepContext &context);

  /// Call before a step of the world that may be cancelled.
  void beginStep() { activeStep_.reset(); }
  /// Undoes a cancelled step: returns to the state of the body before it. Cached distances, friction and factorisations
  /// are reset.
  void undoStep(const ParallelFor &parallelFor);

  /// After undoStep(): how far the step had advanced and what would fit into `budget` seconds.
  [[nodiscard]] std::string suggestAffordableStep(const StepContext &context, double budget);

  /// It is at rest and steps do not change it: no stage runs. Only if WorldSettings::sleep permits.
  [[nodiscard]] bool asleep() const { return asleep_; }
  /// Call when the body or its environment has changed.
  void wake();
  /// Increases whenever the state may have changed.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  void countChange() { ++changes_; }

  /// Call when the body has changed: another material, another reference.
  void invalidate();
  /// The state of the last energy check, from which the steps since are repeated if the energy has grown.
  struct EnergyCheckpoint {
    State state;
    double time = 0.0;  ///< s
    EnergyLevel energy;
  };
  [[nodiscard]] const std::optional<EnergyCheckpoint> &energyCheckpoint() const { return energyCheckpoint_; }
  /// Stores the present state as the energy checkpoint.
  void setEnergyCheckpoint(double time, const EnergyLevel &energy);
  void restoreEnergyCheckpoint();
  /// Call when its energy may change from outside.
  void clearEnergyCheckpoint() { energyCheckpoint_.reset(); }
  /// Island with which it exchanges energy from now on; 0: none. Earlier energies of the body are not comparable with
  /// it.
  void setIsland(std::uint64_t island) {
    if (std::exchange(island_, island) != island) clearEnergyCheckpoint();
  }
  /// Something outside adds energy to the body, or it recovers dissipated energy.
  [[nodiscard]] bool mayGainEnergy(const StepContext &context) const;
  /// Makes the next step depend on the state only, not on earlier steps.
  void resetSolvers() {
    solver_.forget();
    clearEnergyCheckpoint();
  }
  /// Returns to the initial state, bit for bit.
  void reset();

  /// State of the body and of its step-size control.
  struct Checkpoint {
    BodyCheckpoint body;
    SubstepController substeps;
    double scale = 1.0;
    std::uint64_t goodSteps = 0;
  };
  [[nodiscard]] Checkpoint checkpoint() const { return {body_->checkpoint(), substeps_, scale_, goodSteps_}; }
  /// How long it has been at rest. Not part of a checkpoint: a caller restores a checkpoint in order to change
  /// something.
  struct SleepState {
    SleepDetector watch;
    bool asleep = false;
  };
  [[nodiscard]] SleepState sleepState() const { return {sleepDetector_, asleep_}; }
  void setSleepState(SleepState sleepState) {
    sleepDetector_ = std::move(sleepState.watch);
    asleep_ = sleepState.asleep;
  }
  /// Same as Body::restore().
  bool restore(const Checkpoint &checkpoint, const ParallelFor &parallelFor);

 private:
  [[nodiscard]] static tl::unexpected<Refusal> refused(GuardFinding finding, bool crushed = false) {
    return tl::unexpected<Refusal>(Refusal{std::move(finding), crushed});
  }

  [[nodiscard]] double tryToAdvance(const StepContext &context, double span, std::uint64_t maxSubsteps);
  [[nodiscard]] Advance advanceExplicit(const StepContext &context, double span, std::uint64_t maxSubsteps,
                                        const QuickCheckResult &check);
  [[nodiscard]] Advance advanceImplicit(const StepContext &context, double span);
  /// From the energy checkpoint to the end of `span`, in steps of context.dt.
  [[nodiscard]] Advance repeatFromCheckpoint(const StepContext &context, double span);

  std::unique_ptr<Body> body_;
  NewtonSolver solver_;
  std::optional<EnergyCheckpoint> energyCheckpoint_;  // none: the energy cannot be compared
  std::uint64_t island_ = 0;
  SubstepController substeps_;
  SleepDetector sleepDetector_;
  bool asleep_ = false;
  /// State at the beginning of the step, as far as the body does not store it; empty: unchanged.
  struct StepStart {
    SubstepController substeps;
    std::optional<State> state;  // if the body stores a later one
  };
  std::optional<StepStart> activeStep_;
  std::uint64_t changes_ = 0;
  double scale_ = 1.0;  // fraction of the usual step in use, after failures
  std::uint64_t goodSteps_ = 0;
  std::uint64_t maxReportedSubsteps_ = 1;  // already reported
  bool integratorReported_ = false, sharedReported_ = false, slowReported_ = false;
  std::optional<Integrator> sharedIntegrator_;
};

}  // namespace pointbased::detail
