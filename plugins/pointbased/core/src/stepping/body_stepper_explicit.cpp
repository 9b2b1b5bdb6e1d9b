// SPDX-License-Identifier: Apache-2.0
// Explicit steps of a body: how long its substeps may be.
#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "stepping/body_stepper.h"

namespace pointbased::detail {
namespace {

// Of the stable step at rest: below it a body stops (an impact at Mach 27: 1e-3).
constexpr double kCrushed = 3e-4;
// Of the usual step where points may bounce: what Verlet keeps is not quite the energy, and bounces turn the difference
// into rattling. It falls with the square of the step.
constexpr double kBouncing = 0.5;
constexpr double kManyMore = 1.5;  // substeps than usual are worth an event
constexpr double kStride = 0.25;   // spacings a phyxel may go, relative to its body, in a substep

bool bounces(const Environment &env) {
  return (env.box.enabled && env.box.restitution > 0.0) ||
         std::any_of(env.obstacles.begin(), env.obstacles.end(), [](const Obstacle &o) { return o.restitution > 0.0; });
}

}  // namespace

BodyStepper::Gone BodyStepper::maxSubstep(const StepContext &order, double time, double left,
                                          const QuickCheckResult *glance) {
  Body &body = *body_;
  const double rest = body.stableStepAtRest(), bare = body.stableStep(), stride = kStride * body.rest().spacing;
  GuardView view;
  order.environment.clock->measure(kGuard, [&] {
    const QuickCheckResult now = glance != nullptr ? *glance : quickCheck(body);
    if (!now.finite || now.speedBound * bare > stride) view = fullCheck(body);
  });
  if (!view.finite) return refused(firstNonFinite(body));
  const double part = kStepSafety * scale_ * substeps_.care() * (bounces(order.environment) ? kBouncing : 1.0);
  double stable = body.free() ? std::min(part * bare, kFreeStep) : part * bare;
  if (view.fastest > 0.0) stable = std::min(stable, stride / view.fastest);
  // An impact sets phyxels in motion against each other that had the same velocity before.
  const double impact = impactSpeed(body, order.environment, time, std::min(left, stable), stride, view.meanSpeed);
  if (impact > 0.0) stable = std::min(stable, stride / impact);
  const bool crushed = std::isfinite(rest) && !(stable > part * kCrushed * rest);
  if (!crushed) return stable;
  view = fullCheck(body);
  if (!view.finite) return refused(firstNonFinite(body), crushed);
  const std::string why = bare > kCrushed * rest ? "it moves " + number(std::max(view.fastest, impact)) + " m/s"
                                                 : "the body is crushed or inverted";
  return refused({view.fastestPhyxel,
                  "the stable step has fallen to " + number(stable / part) + " s, 1/" + number(rest / stable * part) +
                      " of that at rest: " + why,
                  "solver.integrator = \"implicit\", a smaller solver.dt, or a softer or coarser body"},
                 crushed);
}

BodyStepper::Gone BodyStepper::advanceExplicit(const StepContext &order, double span, std::uint64_t mostSubsteps,
                                               const QuickCheckResult &glance) {
  Body &body = *body_;
  double left = span, time = order.time, needed = 1.0;
  std::uint64_t substeps = 0;
  body.contact.sums.begin(order.environment.obstacles.size());
  while (left > 1e-12 * span && substeps < mostSubsteps) {
    const Gone stable = maxSubstep(order, time, left, substeps == 0 ? &glance : nullptr);
    if (!stable) return stable;
    needed = std::max(needed, substeps_.needed(span, *stable));
    const double piece = substeps_.piece(left, span, *stable);
    explicitSubstep(body, order.environment, time, piece);
    left -= piece;
    time += piece;
    ++substeps;
  }
  // Displacements have grown by these velocities and dt: they are finite where these are.
  bool finite = true;
  order.environment.clock->measure(kGuard, [&] { finite = isFinite(body.state().velocities); });
  if (!finite) return refused(firstNonFinite(body));
  substeps_.end(needed);
  const double gone = left > 1e-12 * span ? time - order.time : span;
  reportSubsteps(order, span, gone, substeps, needed);
  return gone;
}

void BodyStepper::reportSubsteps(const StepContext &order, double span, double gone, std::uint64_t substeps,
                                 double needed) {
  const bool whole = !(gone < span);
  // Where nobody has chosen the step, it is that of another body.
  double own = order.world.dt > 0.0 ? span : kStepSafety * body_->stableStepAtRest();
  if (body_->free()) own = std::min(own, kFreeStep);
  const double expected = std::max(1.0, SubstepController::piecesOf(span, own));
  if (substeps > mostSubsteps_ && static_cast<double>(substeps) > kManyMore * expected) {
    mostSubsteps_ = substeps;
    order.reportEvent("substep", "body '" + body_->name() + "': a step of " + number(span) + " s was divided into " +
                                     (whole ? std::to_string(substeps) : number(needed)) + " substeps of " +
                                     number(gone / static_cast<double>(substeps)) + " s");
  }
  if (whole || slowReported_) return;
  slowReported_ = true;
  order.reportEvent("slowed", "body '" + body_->name() + "': a step ended after " + std::to_string(substeps) +
                                  " substeps at " + number(gone) + " s of " + number(span) +
                                  " s; time goes on by what is done in a step");
}

}  // namespace pointbased::detail
