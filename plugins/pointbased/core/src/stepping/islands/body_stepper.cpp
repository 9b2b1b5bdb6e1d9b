// SPDX-License-Identifier: Apache-2.0
#include "stepping/islands/body_stepper.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/number_text.h"
#include "stepping/monitoring/step_activity.h"
#include "stepping/monitoring/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr std::uint64_t kMaxSubsteps = 10'000, kMinSubsteps = 1'000;  // of a step, before it ends early
constexpr double kMaxWork = 2e7;  // evaluations of points in a step: some seconds, so that a run can be interrupted
constexpr double kSmallestScale = 1.0 / 64;  // smallest fraction of the step size before a body stops
constexpr double kCrushedScale = 1.0 / 4;    // same for a crushed body, for which smaller steps rarely help

}  // namespace

std::uint64_t BodyStepper::maxSubsteps() const {
  const double points = static_cast<double>(std::max<std::size_t>(1, body_->rest().pointCount()));
  return static_cast<std::uint64_t>(
      std::clamp(kMaxWork / points, static_cast<double>(kMinSubsteps), static_cast<double>(kMaxSubsteps)));
}

Integrator BodyStepper::integratorIn(const WorldSettings &world) const {
  if (body_->isFreeRigid()) return Integrator::explicitVerlet;
  if (world.integrator == Integrator::automatic)
    return predictCost(*body_, world.dt).implicitIsCheaper() ? Integrator::implicitSdirk : Integrator::explicitVerlet;
  if (world.integrator == Integrator::explicitVerlet && world.dt <= 0.0 &&
      kStepSafety * body_->stableStepAtRest() < kSmallestExplicitStep)
    return Integrator::implicitSdirk;
  // Without numerical damping the midpoint rule does not settle relaxing materials.
  if (world.integrator == Integrator::implicitMidpoint && body_->constitution().relaxing())
    return Integrator::implicitSdirk;
  return world.integrator;
}

void BodyStepper::wake() {
  asleep_ = false;
  sleepDetector_.clear();
  body_->forcesCurrent = false;
  clearEnergyCheckpoint();
}

bool BodyStepper::remainsAsleep(const StepContext &context, double span) {
  if (!asleep_) return false;
  const Body &body = *body_;
  // A push from outside shows as a velocity.
  const bool pushed = std::any_of(body.state().velocities.begin(), body.state().velocities.end(),
                                  [](const Vec3 &v) { return !v.isZero(0.0); });
  if (!pushed && context.world.sleep && !isDriven(body, context.environment.obstacles, context.time, span)) return true;
  wake();
  return false;
}

bool BodyStepper::isAtRest(const StepContext &context, double span) {
  if (!context.world.sleep || stopped() || isDriven(*body_, context.environment.obstacles, context.time, span)) {
    sleepDetector_.clear();
    return false;
  }
  const double tolerance =
      context.world.tolerance > 0.0 ? context.world.tolerance : SleepDetector::kTolerance * body_->rest().spacing;
  return sleepDetector_.update(*body_, tolerance, span);
}

void BodyStepper::fallAsleep() {
  asleep_ = true;
  std::fill(body_->state().velocities.begin(), body_->state().velocities.end(), Vec3(Vec3::Zero()));
  if (activeStep_) activeStep_->state = body_->savedStateCopy();
  body_->keepState();
}

void BodyStepper::invalidate() {
  wake();
  ++changes_;
  solver_.forget();
}

void BodyStepper::reset() {
  body_->reset();
  invalidate();
  substeps_ = SubstepController();
  scale_ = 1.0;
  goodSteps_ = 0;
  maxReportedSubsteps_ = 1;
  integratorReported_ = sharedReported_ = false;
  sharedIntegrator_.reset();
  slowReported_ = false;
}

bool BodyStepper::restore(const Checkpoint &checkpoint, const ParallelFor &parallelFor) {
  if (!body_->restore(checkpoint.body, parallelFor)) return false;
  invalidate();
  substeps_ = checkpoint.substeps;
  scale_ = checkpoint.scale;
  goodSteps_ = checkpoint.goodSteps;
  return true;
}

void BodyStepper::undoStep(const ParallelFor &parallelFor) {
  if (!activeStep_) return;
  substeps_ = activeStep_->substeps;
  if (activeStep_->state) {
    body_->state() = *activeStep_->state;
    body_->keepState();
  }
  activeStep_.reset();
  body_->restoreState();
  body_->contact.blocks = ContactState::Blocks();
  body_->computeGradients(parallelFor);
  body_->computeTrialStresses(0.0, parallelFor);
  wake();
  solver_.forget();
  ++changes_;
}

std::string BodyStepper::suggestAffordableStep(const StepContext &context, double budget) {
  Body &body = *body_;
  const ParallelFor &parallelFor = *context.environment.parallelFor;
  // The second run finds its data in the caches. Where kernels have no evaluation without history, the separate stages
  // are used.
  double seconds = 0.0;
  for (int k = 0; k < 2; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    if (body.vectorisedTangent()) {
      body.evaluateInternal(false, parallelFor);
    } else {
      body.computeGradients(parallelFor);
      body.computeTrialStresses(0.0, parallelFor);
      body.computeInternalForces(parallelFor);
    }
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  const NewtonResult &solved = solver_.progress();
  return detail::suggestAffordableStep(body, integratorIn(context.world),
                                       {context.dt, budget, seconds, solved.iterations, solved.linearIterations});
}

void BodyStepper::beginAdvance(const StepContext &context) {
  ++changes_;
  if (context.environment.stop != nullptr) activeStep_ = StepStart{substeps_, {}};
  substeps_.begin(context.dt);
}

double BodyStepper::advance(const StepContext &context, double span) {
  if (body_->isStatic()) return span;
  if (remainsAsleep(context, span)) {
    substeps_.begin(context.dt);
    return span;
  }
  beginAdvance(context);
  reportIntegrator(context);
  const double advanced = tryToAdvance(context, span, maxSubsteps());
  if (isAtRest(context, advanced)) fallAsleep();
  return advanced;
}

void BodyStepper::advanceAgain(const StepContext &context, double span) {
  if (asleep_) return;  // the state does not depend on the time
  body_->restoreState();
  (void)tryToAdvance(context, span, std::numeric_limits<std::uint64_t>::max());
}

std::optional<QuickCheckResult> BodyStepper::checkpointIfValid(const StepContext &context) {
  Body &body = *body_;
  // Invalid external changes are detected before the state is stored for undoing.
  QuickCheckResult check;
  context.environment.clock->measure(kGuard, [&] { check = quickCheck(body); });
  if (!check.finite) {
    const GuardFinding poisoned = firstNonFinite(body);
    body.restoreState();
    stop(context, poisoned);
    return std::nullopt;
  }
  for (const ActiveGrab &active : body.grabs)
    if (!active.grab.target.allFinite() || !active.grab.rotation.allFinite()) {
      stop(context,
           {active.grab.phyxels.front(), "the hand that holds it is at no finite place", "to let go and reset"});
      return std::nullopt;
    }
  body.keepState();
  (void)body.constitution().consumeError();  // of an earlier step
  return check;
}

void BodyStepper::restoreStepStart(const ParallelFor &parallelFor) {
  body_->restoreState();
  body_->computeGradients(parallelFor);
  body_->computeTrialStresses(0.0, parallelFor);
  solver_.forget();
  goodSteps_ = 0;
}

bool BodyStepper::retryWithSmallerStep(const StepContext &context, const Refusal &refusal, const std::string &from) {
  Body &body = *body_;
  restoreStepStart(*context.environment.parallelFor);
  GuardFinding finding = refusal.finding;
  if (const std::string law = body.constitution().consumeError(); !law.empty()) finding.quantity += "; " + law;
  if (!(scale_ > (refusal.crushed ? kCrushedScale : kSmallestScale))) {
    stop(context, finding);
    return false;
  }
  scale_ *= 0.5;
  context.reportEvent("smaller_step", "body '" + body.name() + "', phyxel " + std::to_string(finding.phyxel) + ": " +
                                          finding.quantity + "; back to the state " + from + ", with steps " +
                                          number(1.0 / scale_) + " times smaller");
  return true;
}

void BodyStepper::endAdvance() {
  if (!(scale_ < 1.0) || ++goodSteps_ < kPatience) return;
  scale_ = std::min(1.0, 2.0 * scale_);
  goodSteps_ = 0;
}

double BodyStepper::tryToAdvance(const StepContext &context, double span, std::uint64_t maxSubsteps) {
  Body &body = *body_;
  const Integrator integrator = integratorIn(context.world);
  const std::optional<QuickCheckResult> check = checkpointIfValid(context);
  if (!check) return span;
  bool again = false;  // starting at the energy checkpoint
  while (true) {
    Advance advanced = again                                      ? repeatFromCheckpoint(context, span)
                       : integrator == Integrator::explicitVerlet ? advanceExplicit(context, span, maxSubsteps, *check)
                                                                  : advanceImplicit(context, span);
    if (advanced && context.number % kEnergyInterval == 0)
      context.environment.clock->measure(kGuard, [&] {
        const EnergyLevel now = energyLevel(body, context.world.gravity);
        const bool comparable = energyCheckpoint_.has_value() && !mayGainEnergy(context);
        if (std::string grown = comparable ? energyGrowth(energyCheckpoint_->energy, now) : std::string();
            !grown.empty()) {
          advanced = refused({fullCheck(body).fastestPhyxel, std::move(grown), kLessEnergy});
          restoreEnergyCheckpoint();
          again = true;
        } else {
          setEnergyCheckpoint(context.time + *advanced, now);
        }
        body.contact.depenetrationMoment.setZero();
      });
    if (advanced) {
      endAdvance();
      return *advanced;
    }
    if (!retryWithSmallerStep(context, advanced.error(),
                              again ? "at " + number(energyCheckpoint_->time) + " s" : "before"))
      return span;
  }
}

// Wider than isDriven(): after a ramp, oscillations still exchange energy with the support.
bool BodyStepper::mayGainEnergy(const StepContext &context) const {
  if (!body_->grabs.empty() || !body_->externalForces().empty()) return true;
  for (const Obstacle &obstacle : context.environment.obstacles)
    if (obstacle.motion) return true;
  const BoundaryConditions &conditions = body_->rest().conditions;
  for (const Fix &fix : conditions.fixes)
    if (fix.ramp > 0.0 && context.time <= 1.5 * fix.ramp) return true;
  for (const LiveSupport &support : body_->liveSupports())
    if (support.ramp > 0.0 && context.time <= support.start + 1.5 * support.ramp) return true;
  for (const Load &load : conditions.loads)
    if ((load.ramp > 0.0 && context.time <= 1.5 * load.ramp) || (load.pressure != 0.0 && load.follower)) return true;
  return !body_->rigid() && body_->constitution().relaxing();
}

void BodyStepper::setEnergyCheckpoint(double time, const EnergyLevel &energy) {
  if (!energyCheckpoint_) energyCheckpoint_ = EnergyCheckpoint();
  energyCheckpoint_->state = body_->state();
  energyCheckpoint_->time = time;
  energyCheckpoint_->energy = energy;
}

void BodyStepper::restoreEnergyCheckpoint() {
  if (activeStep_ && !activeStep_->state) activeStep_->state = body_->savedStateCopy();
  body_->state() = energyCheckpoint_->state;
  body_->keepState();
}

BodyStepper::Advance BodyStepper::repeatFromCheckpoint(const StepContext &context, double span) {
  const double end = context.time + span;
  const Integrator integrator = integratorIn(context.world);
  StepContext piece = context;
  piece.time = energyCheckpoint_->time;
  while (end - piece.time > 1e-9 * span) {
    const double left = std::min(context.dt, end - piece.time);
    const Advance advanced =
        integrator == Integrator::explicitVerlet
            ? advanceExplicit(piece, left, std::numeric_limits<std::uint64_t>::max(), quickCheck(*body_))
            : advanceImplicit(piece, left);
    if (!advanced) return advanced;
    piece.time += left;
  }
  return span;
}

BodyStepper::Advance BodyStepper::advanceImplicit(const StepContext &context, double span) {
  const Integrator scheme = integratorIn(context.world);
  const auto pieces = static_cast<int>(std::llround(std::ceil(1.0 / scale_)));
  const double piece = span / pieces;
  body_->contact.sums.begin(context.environment.obstacles.size());
  for (int k = 0; k < pieces; ++k) {
    const ImplicitResult result =
        implicitStep(*body_, solver_, context.environment, context.time + k * piece, piece, scheme);
    if (!result.failure.empty())
      return refused(
          {result.newton.worst, result.failure,
           "a smaller solver.dt, solver.integrator = \"backward_euler\", or material.law = \"neo_hookean\""});
    bool finite = true;
    context.environment.clock->measure(kGuard, [&] { finite = quickCheck(*body_).finite; });
    if (!finite) return refused(firstNonFinite(*body_));
  }
  return span;
}

void BodyStepper::reportIntegrator(const StepContext &context) {
  if (integratorReported_ || integratorIn(context.world) == context.world.integrator) return;
  integratorReported_ = true;
  const std::string body = "body '" + body_->name() + "' ";
  if (body_->isFreeRigid()) {
    if (context.world.integrator != Integrator::automatic)
      context.reportEvent("chosen", body + "is rigid and moves freely, in explicit steps: nothing of it is stiff");
    return;
  }
  if (context.world.integrator == Integrator::automatic) {
    if (integratorIn(context.world) != Integrator::implicitSdirk) return;
    const StepCost cost = predictCost(*body_, context.world.dt);
    context.reportEvent("chosen",
                        body + "is integrated implicitly: predicted to cost " + number(cost.implicitEvaluations) +
                            " force evaluations per simulated second instead of " + number(cost.explicitEvaluations) +
                            "; solver.integrator = \"explicit\" resolves its vibrations");
  } else if (context.world.integrator == Integrator::implicitMidpoint)
    context.reportEvent("switched",
                        body + "relaxes, which the midpoint rule does not settle; it is given \"implicit\"");
  else
    context.reportEvent("switched",
                        body + "is so stiff that explicit steps would be " +
                            number(kStepSafety * body_->stableStepAtRest()) +
                            " s long; it is integrated implicitly. If it hardly deforms, make it an obstacle (rigid)");
}

void BodyStepper::reportShared(const StepContext &context, const std::string &names, const std::string &free) {
  if (sharedReported_) return;
  sharedReported_ = true;
  if (!free.empty()) {
    context.reportEvent("chosen", "bodies " + names + " touch each other or are attached and take explicit steps " +
                                      "together: body '" + free +
                                      "' is rigid and moves freely, which implicit steps do not know");
    return;
  }
  context.reportEvent("chosen",
                      "bodies " + names +
                          " touch each other and take explicit steps together: an implicit one of all of them is "
                          "predicted to cost more; solver.integrator = \"implicit\" takes it nevertheless");
}

void BodyStepper::stop(const StepContext &context, const GuardFinding &finding) {
  Body &body = *body_;
  const ParallelFor &parallelFor = *context.environment.parallelFor;
  // Forces and strains of the state that is retained, not of the failed step.
  const double t = body.quasiStatic ? context.loadFactor : context.time;
  if (body.vectorisedTangent()) {
    body.evaluate(t, 0.0, parallelFor);
  } else {
    body.computeGradients(parallelFor);
    body.computeTrialStresses(0.0, parallelFor);
    body.computeForces(t, parallelFor);
  }
  body.stopped = finding;
  context.reportEvent("stopped", body.stopMessage());
}

}  // namespace pointbased::detail
