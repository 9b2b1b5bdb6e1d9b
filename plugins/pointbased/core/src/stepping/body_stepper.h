// SPDX-License-Identifier: Apache-2.0
// One body through the steps of its world. Private to the core.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "pointbased/world_settings.h"
#include "stepping/guard.h"
#include "stepping/sleep_detector.h"
#include "stepping/substep_controller.h"

namespace pointbased::detail {

/// One step of the world, as its bodies are asked to take it.
struct StepContext {
  const WorldSettings &world;
  Environment environment;
  double time = 0.0;                                                           ///< s, at its beginning
  double dt = 0.0;                                                             ///< s, its size
  double loadFactor = 0.0;                                                     ///< that has been reached; quasi-static
  std::uint64_t number = 1;                                                    ///< steps with this one
  std::function<void(const char *kind, const std::string &text)> reportEvent;  ///< who hears what had to be done
};

/// Advances one body and tells what it had to do.
///
/// What the guard refuses is undone and tried again with steps half as long, down to 1/64 (crushed bodies: 1/4); good
/// steps make them longer again. Energy that came from nothing has come within the steps since the last look at it, so
/// these are all taken again, from the state of that look. Where nothing helps the body stops in the last good state.
class BodyStepper {
 public:
  explicit BodyStepper(std::unique_ptr<Body> body) : body_(std::move(body)) {}

  [[nodiscard]] Body &body() { return *body_; }
  [[nodiscard]] const Body &body() const { return *body_; }
  [[nodiscard]] bool stopped() const { return body_->stopped.has_value(); }
  /// The world's, or another where that would not do (noted once).
  [[nodiscard]] Integrator integratorIn(const WorldSettings &world) const;
  /// What integrates it together with those that it touches or is attached to; nothing: it goes by itself.
  void share(std::optional<Integrator> scheme) { shared_ = scheme; }
  [[nodiscard]] Integrator integratorNow(const WorldSettings &world) const {
    return shared_.value_or(integratorIn(world));
  }

  /// On by `span`, of a step of order.dt.
  /// @param span  s, <= order.dt: what another body has left of the step
  /// @return s that it has gone: less where the substeps of a step were not enough; `span` where it has stopped
  [[nodiscard]] double advance(const StepContext &order, double span);
  /// The last advance() again, only as far as another body has come, in as many substeps as that takes.
  void advanceAgain(const StepContext &order, double span);
  /// Quasi-static: from order.loadFactor on, in smaller increments where this one is too large.
  void loadUpTo(const StepContext &order, double factor);

  // The parts of advance(), for bodies that touch others and advance together with them (body_group.h):
  struct Refusal {
    GuardFinding finding;
    bool crushed = false;
  };
  using Gone = tl::expected<double, Refusal>;  // s
  /// Whether it rests on; wakes it where something has changed. Once per step.
  [[nodiscard]] bool sleepsOn(const StepContext &order, double span);
  void beginAdvance(const StepContext &order);
  /// Whether its state can be advanced, which is kept then; else it stops.
  [[nodiscard]] std::optional<QuickCheckResult> keepIfSound(const StepContext &order);
  /// Length of the substep that the body can take now, s.
  [[nodiscard]] Gone maxSubstep(const StepContext &order, double time, double left, const QuickCheckResult *glance);
  /// Back to the state before the step; the next attempt takes steps half as long.
  /// @param from  the state it goes back to, for the event
  /// @return false: it has stopped there instead, because smaller steps did not help
  [[nodiscard]] bool tryAgain(const StepContext &order, const Refusal &refusal, const std::string &from = "before");
  /// Likewise, because another one has to.
  void goBack(const ParallelFor &parallelFor);
  /// The step is done.
  void endAdvance();
  [[nodiscard]] SubstepController &substeps() { return substeps_; }
  void reportSubsteps(const StepContext &order, double span, double gone, std::uint64_t substeps, double needed);
  /// Whether it has been still for long enough to sleep.
  [[nodiscard]] bool isStill(const StepContext &order, double span);
  void fallAsleep();
  [[nodiscard]] std::uint64_t mostSubsteps() const;
  void reportIntegrator(const StepContext &order);
  /// That it takes explicit steps, because it touches others; once.
  /// @param free  the one of them that is rigid and moves freely; empty: none is
  void reportShared(const StepContext &order, const std::string &names, const std::string &free);
  /// Times by which steps are made smaller now, and who says so.
  [[nodiscard]] double stepScale() const { return scale_; }
  /// The body stays in the state that it is in.
  void stop(const StepContext &order, const GuardFinding &finding);
  /// Before increments of the load that somebody may end.
  void beginLoad(const StepContext &order);

  /// Before a step of the world that somebody may end.
  void beginStep() { underWay_.reset(); }
  /// The step was ended half way: back to where the body was before it. What is remembered of distances, friction and
  /// factorisations starts anew.
  void undoStep(const ParallelFor &parallelFor);

  /// After undoStep(): how far the step had come and what would fit into `budget` seconds.
  [[nodiscard]] std::string whatWouldFit(const StepContext &order, double budget);

  /// It rests, and steps leave it as it is: no stage runs. Only where WorldSettings::sleep allows.
  [[nodiscard]] bool asleep() const { return asleep_; }
  /// Something around it or of it has changed.
  void wake();
  /// Grows with every step that may have changed the state.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  /// The body is not what it was: another material, another reference.
  void forget();
  /// The state of the last look at the energy, with which the steps since then begin again where it has grown.
  struct Mark {
    State state;
    double time = 0.0;  ///< s
    EnergyLevel energy;
  };
  [[nodiscard]] const std::optional<Mark> &mark() const { return mark_; }
  /// It is in order now.
  void setMark(double time, const EnergyLevel &energy);
  void backToMark();
  /// Its energy may change from outside.
  void forgetEnergy() { mark_.reset(); }
  /// With whom it exchanges energy from here on; 0: with nobody. What it had before tells nothing of others.
  void setGroup(std::uint64_t group) {
    if (std::exchange(group_, group) != group) forgetEnergy();
  }
  /// Something outside puts energy into the body, or it takes up what it has lost.
  [[nodiscard]] bool mayGainEnergy(const StepContext &order) const;
  /// Nothing of earlier steps is used by the next one but the state.
  void startSolversAnew() {
    solver_.forget();
    forgetEnergy();
  }
  /// To the initial state, bit for bit.
  void reset();

  /// The body as it is and how its steps are cut.
  struct Checkpoint {
    BodyCheckpoint body;
    SubstepController substeps;
    double scale = 1.0;
    std::uint64_t goodSteps = 0;
  };
  [[nodiscard]] Checkpoint checkpoint() const { return {body_->checkpoint(), substeps_, scale_, goodSteps_}; }
  /// How long it has been still, which a checkpoint forgets: who goes back does so to change something.
  struct Stillness {
    SleepDetector watch;
    bool asleep = false;
  };
  [[nodiscard]] Stillness stillness() const { return {watch_, asleep_}; }
  void setStillness(Stillness stillness) {
    watch_ = std::move(stillness.watch);
    asleep_ = stillness.asleep;
  }
  /// As Body::restore().
  bool restore(const Checkpoint &checkpoint, const ParallelFor &parallelFor);

 private:
  [[nodiscard]] static tl::unexpected<Refusal> refused(GuardFinding finding, bool crushed = false) {
    return tl::unexpected<Refusal>(Refusal{std::move(finding), crushed});
  }

  [[nodiscard]] double tryToAdvance(const StepContext &order, double span, std::uint64_t mostSubsteps);
  [[nodiscard]] Gone advanceExplicit(const StepContext &order, double span, std::uint64_t mostSubsteps,
                                     const QuickCheckResult &glance);
  [[nodiscard]] Gone advanceImplicit(const StepContext &order, double span);
  /// From the mark to the end of `span`, in steps of order.dt.
  [[nodiscard]] Gone againFromMark(const StepContext &order, double span);

  std::unique_ptr<Body> body_;
  NewtonSolver solver_;
  std::optional<Mark> mark_;  // none: the energy cannot be compared
  std::uint64_t group_ = 0;
  SubstepController substeps_;
  SleepDetector watch_;
  bool asleep_ = false;
  /// What the state that the body keeps does not say of the beginning of the step; empty: nothing of it was touched.
  struct Start {
    SubstepController substeps;
    std::optional<State> state;  // where the body keeps a later one
  };
  std::optional<Start> underWay_;
  std::uint64_t changes_ = 0;
  double scale_ = 1.0;  // part of the usual step in use, after failures
  std::uint64_t goodSteps_ = 0;
  std::uint64_t mostSubsteps_ = 1;  // that have been told
  bool integratorReported_ = false, sharedReported_ = false, slowReported_ = false;
  std::optional<Integrator> shared_;
};

}  // namespace pointbased::detail
