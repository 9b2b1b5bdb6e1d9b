// SPDX-License-Identifier: Apache-2.0
#include "stepping/body_stepper.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/number_text.h"
#include "stepping/step_activity.h"
#include "stepping/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr std::uint64_t kMostSubsteps = 10'000, kLeastSubsteps = 1'000;  // of a step, before it ends early
constexpr double kMostWork = 2e7;  // evaluations of points in a step: some seconds, so that a run can be interrupted
constexpr double kSmallestScale = 1.0 / 64;  // of the steps that are tried before a body stops
constexpr double kCrushedScale = 1.0 / 4;    // likewise where it is crushed, which smaller steps seldom change

}  // namespace

std::uint64_t BodyStepper::mostSubsteps() const {
  const double points = static_cast<double>(std::max<std::size_t>(1, body_->rest().pointCount()));
  return static_cast<std::uint64_t>(
      std::clamp(kMostWork / points, static_cast<double>(kLeastSubsteps), static_cast<double>(kMostSubsteps)));
}

Integrator BodyStepper::integratorIn(const WorldSettings &world) const {
  if (body_->free()) return Integrator::explicitVerlet;
  if (world.integrator == Integrator::automatic)
    return predictCost(*body_, world.dt).implicitIsCheaper() ? Integrator::implicitSdirk : Integrator::explicitVerlet;
  if (world.integrator == Integrator::explicitVerlet && world.dt <= 0.0 &&
      kStepSafety * body_->stableStepAtRest() < kSmallestExplicitStep)
    return Integrator::implicitSdirk;
  // Without damping of its own the midpoint rule does not settle what relaxes.
  if (world.integrator == Integrator::implicitMidpoint && body_->constitution().relaxing())
    return Integrator::implicitSdirk;
  return world.integrator;
}

void BodyStepper::wake() {
  asleep_ = false;
  watch_.forget();
  body_->forcesCurrent = false;
  forgetEnergy();
}

bool BodyStepper::sleepsOn(const StepContext &order, double span) {
  if (!asleep_) return false;
  const Body &body = *body_;
  // Whoever has pushed it from outside has given it a velocity.
  const bool pushed = std::any_of(body.state().velocities.begin(), body.state().velocities.end(),
                                  [](const Vec3 &v) { return !v.isZero(0.0); });
  if (!pushed && order.world.sleep && !isDriven(body, order.environment.obstacles, order.time, span)) return true;
  wake();
  return false;
}

bool BodyStepper::isStill(const StepContext &order, double span) {
  if (!order.world.sleep || stopped() || isDriven(*body_, order.environment.obstacles, order.time, span)) {
    watch_.forget();
    return false;
  }
  const double tolerance =
      order.world.tolerance > 0.0 ? order.world.tolerance : SleepDetector::kTolerance * body_->rest().spacing;
  return watch_.look(*body_, tolerance, span);
}

void BodyStepper::fallAsleep() {
  asleep_ = true;
  std::fill(body_->state().velocities.begin(), body_->state().velocities.end(), Vec3(Vec3::Zero()));
  if (underWay_) underWay_->state = body_->keptState();
  body_->keepState();
}

void BodyStepper::forget() {
  wake();
  ++changes_;
  solver_.forget();
}

void BodyStepper::reset() {
  body_->reset();
  forget();
  substeps_ = SubstepController();
  scale_ = 1.0;
  goodSteps_ = 0;
  mostSubsteps_ = 1;
  integratorReported_ = sharedReported_ = false;
  shared_.reset();
  slowReported_ = false;
}

bool BodyStepper::restore(const Checkpoint &checkpoint, const ParallelFor &parallelFor) {
  if (!body_->restore(checkpoint.body, parallelFor)) return false;
  forget();
  substeps_ = checkpoint.substeps;
  scale_ = checkpoint.scale;
  goodSteps_ = checkpoint.goodSteps;
  return true;
}

void BodyStepper::undoStep(const ParallelFor &parallelFor) {
  if (!underWay_) return;
  substeps_ = underWay_->substeps;
  if (underWay_->state) {
    body_->state() = *underWay_->state;
    body_->keepState();
  }
  underWay_.reset();
  body_->restoreState();
  body_->contact.blocks = ContactState::Blocks();
  body_->computeGradients(parallelFor);
  body_->computeTrialStresses(0.0, parallelFor);
  wake();
  solver_.forget();
  ++changes_;
}

std::string BodyStepper::whatWouldFit(const StepContext &order, double budget) {
  Body &body = *body_;
  const ParallelFor &parallelFor = *order.environment.parallelFor;
  // The second one finds in the caches what it needs. Where kernels have no evaluation without memory, stages do it.
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
  return detail::whatWouldFit(body, integratorIn(order.world),
                              {order.dt, budget, seconds, solved.iterations, solved.linearIterations});
}

void BodyStepper::beginAdvance(const StepContext &order) {
  ++changes_;
  if (order.environment.stop != nullptr) underWay_ = Start{substeps_, {}};
  substeps_.begin(order.dt);
}

double BodyStepper::advance(const StepContext &order, double span) {
  if (body_->stands()) return span;
  if (sleepsOn(order, span)) {
    substeps_.begin(order.dt);
    return span;
  }
  beginAdvance(order);
  reportIntegrator(order);
  const double gone = tryToAdvance(order, span, mostSubsteps());
  if (isStill(order, gone)) fallAsleep();
  return gone;
}

void BodyStepper::advanceAgain(const StepContext &order, double span) {
  if (asleep_) return;  // the state is the same at every time
  body_->restoreState();
  (void)tryToAdvance(order, span, std::numeric_limits<std::uint64_t>::max());
}

std::optional<QuickCheckResult> BodyStepper::keepIfSound(const StepContext &order) {
  Body &body = *body_;
  // What somebody has put in from outside is caught before it becomes the state to go back to.
  QuickCheckResult glance;
  order.environment.clock->measure(kGuard, [&] { glance = quickCheck(body); });
  if (!glance.finite) {
    const GuardFinding poisoned = firstNonFinite(body);
    body.restoreState();
    stop(order, poisoned);
    return std::nullopt;
  }
  for (const Hand &hand : body.hands)
    if (!hand.grab.target.allFinite() || !hand.grab.rotation.allFinite()) {
      stop(order, {hand.grab.phyxels.front(), "the hand that holds it is at no finite place", "to let go and reset"});
      return std::nullopt;
    }
  body.keepState();
  (void)body.constitution().takeComplaint();  // of an earlier step
  return glance;
}

void BodyStepper::goBack(const ParallelFor &parallelFor) {
  body_->restoreState();
  body_->computeGradients(parallelFor);
  body_->computeTrialStresses(0.0, parallelFor);
  solver_.forget();
  goodSteps_ = 0;
}

bool BodyStepper::tryAgain(const StepContext &order, const Refusal &refusal, const std::string &from) {
  Body &body = *body_;
  goBack(*order.environment.parallelFor);
  GuardFinding finding = refusal.finding;
  if (const std::string law = body.constitution().takeComplaint(); !law.empty()) finding.quantity += "; " + law;
  if (!(scale_ > (refusal.crushed ? kCrushedScale : kSmallestScale))) {
    stop(order, finding);
    return false;
  }
  scale_ *= 0.5;
  order.reportEvent("smaller_step", "body '" + body.name() + "', phyxel " + std::to_string(finding.phyxel) + ": " +
                                        finding.quantity + "; back to the state " + from + ", with steps " +
                                        number(1.0 / scale_) + " times smaller");
  return true;
}

void BodyStepper::endAdvance() {
  if (!(scale_ < 1.0) || ++goodSteps_ < kPatience) return;
  scale_ = std::min(1.0, 2.0 * scale_);
  goodSteps_ = 0;
}

double BodyStepper::tryToAdvance(const StepContext &order, double span, std::uint64_t mostSubsteps) {
  Body &body = *body_;
  const Integrator integrator = integratorIn(order.world);
  const std::optional<QuickCheckResult> glance = keepIfSound(order);
  if (!glance) return span;
  bool again = false;  // from the mark
  while (true) {
    Gone gone = again                                      ? againFromMark(order, span)
                : integrator == Integrator::explicitVerlet ? advanceExplicit(order, span, mostSubsteps, *glance)
                                                           : advanceImplicit(order, span);
    if (gone && order.number % kEnergyInterval == 0)
      order.environment.clock->measure(kGuard, [&] {
        const EnergyLevel now = energyLevel(body, order.world.gravity);
        const bool comparable = mark_.has_value() && !mayGainEnergy(order);
        if (std::string grown = comparable ? energyGrowth(mark_->energy, now) : std::string(); !grown.empty()) {
          gone = refused({fullCheck(body).fastestPhyxel, std::move(grown), kLessEnergy});
          backToMark();
          again = true;
        } else {
          setMark(order.time + *gone, now);
        }
        body.contact.ledOut.setZero();
      });
    if (gone) {
      endAdvance();
      return *gone;
    }
    if (!tryAgain(order, gone.error(), again ? "at " + number(mark_->time) + " s" : "before")) return span;
  }
}

// Wider than isDriven(): after a ramp what swings still exchanges energy with its support.
bool BodyStepper::mayGainEnergy(const StepContext &order) const {
  if (!body_->hands.empty() || !body_->externalForces().empty()) return true;
  for (const Obstacle &obstacle : order.environment.obstacles)
    if (obstacle.motion) return true;
  const BoundaryConditions &conditions = body_->rest().conditions;
  for (const Fix &fix : conditions.fixes)
    if (fix.ramp > 0.0 && order.time <= 1.5 * fix.ramp) return true;
  for (const Load &load : conditions.loads)
    if ((load.ramp > 0.0 && order.time <= 1.5 * load.ramp) || (load.pressure != 0.0 && load.follower)) return true;
  return !body_->rigid() && body_->constitution().relaxing();
}

void BodyStepper::setMark(double time, const EnergyLevel &energy) {
  if (!mark_) mark_ = Mark();
  mark_->state = body_->state();
  mark_->time = time;
  mark_->energy = energy;
}

void BodyStepper::backToMark() {
  if (underWay_ && !underWay_->state) underWay_->state = body_->keptState();
  body_->state() = mark_->state;
  body_->keepState();
}

BodyStepper::Gone BodyStepper::againFromMark(const StepContext &order, double span) {
  const double end = order.time + span;
  const Integrator integrator = integratorIn(order.world);
  StepContext piece = order;
  piece.time = mark_->time;
  while (end - piece.time > 1e-9 * span) {
    const double left = std::min(order.dt, end - piece.time);
    const Gone gone = integrator == Integrator::explicitVerlet
                          ? advanceExplicit(piece, left, std::numeric_limits<std::uint64_t>::max(), quickCheck(*body_))
                          : advanceImplicit(piece, left);
    if (!gone) return gone;
    piece.time += left;
  }
  return span;
}

BodyStepper::Gone BodyStepper::advanceImplicit(const StepContext &order, double span) {
  const Integrator scheme = integratorIn(order.world);
  const auto pieces = static_cast<int>(std::llround(std::ceil(1.0 / scale_)));
  const double piece = span / pieces;
  body_->contact.sums.begin(order.environment.obstacles.size());
  for (int k = 0; k < pieces; ++k) {
    const ImplicitResult result =
        implicitStep(*body_, solver_, order.environment, order.time + k * piece, piece, scheme);
    if (!result.failure.empty())
      return refused(
          {result.newton.worst, result.failure,
           "a smaller solver.dt, solver.integrator = \"backward_euler\", or material.law = \"neo_hookean\""});
    bool finite = true;
    order.environment.clock->measure(kGuard, [&] { finite = quickCheck(*body_).finite; });
    if (!finite) return refused(firstNonFinite(*body_));
  }
  return span;
}

void BodyStepper::reportIntegrator(const StepContext &order) {
  if (integratorReported_ || integratorIn(order.world) == order.world.integrator) return;
  integratorReported_ = true;
  const std::string body = "body '" + body_->name() + "' ";
  if (body_->free()) {
    if (order.world.integrator != Integrator::automatic)
      order.reportEvent("chosen", body + "is rigid and moves freely, in explicit steps: nothing of it is stiff");
    return;
  }
  if (order.world.integrator == Integrator::automatic) {
    if (integratorIn(order.world) != Integrator::implicitSdirk) return;
    const StepCost cost = predictCost(*body_, order.world.dt);
    order.reportEvent("chosen",
                      body + "is integrated implicitly: predicted to cost " + number(cost.implicitEvaluations) +
                          " force evaluations per simulated second instead of " + number(cost.explicitEvaluations) +
                          "; solver.integrator = \"explicit\" resolves its vibrations");
  } else if (order.world.integrator == Integrator::implicitMidpoint)
    order.reportEvent("switched", body + "relaxes, which the midpoint rule does not settle; it is given \"implicit\"");
  else
    order.reportEvent("switched",
                      body + "is so stiff that explicit steps would be " +
                          number(kStepSafety * body_->stableStepAtRest()) +
                          " s long; it is integrated implicitly. If it hardly deforms, make it an obstacle (rigid)");
}

void BodyStepper::reportShared(const StepContext &order, const std::string &names, const std::string &free) {
  if (sharedReported_) return;
  sharedReported_ = true;
  if (!free.empty()) {
    order.reportEvent("chosen", "bodies " + names + " touch each other or are attached and take explicit steps " +
                                    "together: body '" + free +
                                    "' is rigid and moves freely, which implicit steps do not know");
    return;
  }
  order.reportEvent("chosen",
                    "bodies " + names +
                        " touch each other and take explicit steps together: an implicit one of all of them is "
                        "predicted to cost more; solver.integrator = \"implicit\" takes it nevertheless");
}

void BodyStepper::stop(const StepContext &order, const GuardFinding &finding) {
  Body &body = *body_;
  const ParallelFor &parallelFor = *order.environment.parallelFor;
  // Forces and strains of the state that stays, not of the step that failed.
  const double t = body.quasiStatic ? order.loadFactor : order.time;
  if (body.vectorisedTangent()) {
    body.evaluate(t, 0.0, parallelFor);
  } else {
    body.computeGradients(parallelFor);
    body.computeTrialStresses(0.0, parallelFor);
    body.computeForces(t, parallelFor);
  }
  body.stopped = finding;
  order.reportEvent("stopped", body.stopMessage());
}

}  // namespace pointbased::detail
