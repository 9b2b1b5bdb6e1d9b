// SPDX-License-Identifier: Apache-2.0
// Explicit steps of a body: the size of its substeps.
#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "stepping/islands/body_stepper.h"

namespace pointbased::detail {
namespace {

// Fraction of the stable step at rest, below which a body stops (an impact at Mach 27: 1e-3).
constexpr double kCrushed = 3e-4;
// Fraction of the usual step if points may bounce: Verlet conserves the energy only approximately, and bounces turn the
// difference into rattling. It decreases with the square of the step.
constexpr double kBouncing = 0.5;
constexpr double kManyMore = 1.5;  // ratio of substeps to the usual number from which an event is reported
constexpr double kStride = 0.25;   // spacings that a phyxel may move, relative to its body, in a substep

bool bounces(const Environment &env) {
  return (env.box.enabled && env.box.restitution > 0.0) ||
         std::any_of(env.obstacles.begin(), env.obstacles.end(), [](const Obstacle &o) { return o.restitution > 0.0; });
}

}  // namespace

BodyStepper::Advance BodyStepper::maxSubstep(const StepContext &context, double time, double left,
                                             const QuickCheckResult *check) {
  Body &body = *body_;
  const double rest = body.stableStepAtRest(), bare = body.stableStep(), stride = kStride * body.rest().spacing;
  GuardView view;
  context.environment.clock->measure(kGuard, [&] {
    const QuickCheckResult now = check != nullptr ? *check : quickCheck(body);
    if (!now.finite || now.speedBound * bare > stride) view = fullCheck(body);
  });
  if (!view.finite) return refused(firstNonFinite(body));
  const double part = kStepSafety * scale_ * substeps_.stepSafety() * (bounces(context.environment) ? kBouncing : 1.0);
  double stable = body.isFreeRigid() ? std::min(part * bare, kFreeStep) : part * bare;
  if (view.fastest > 0.0) stable = std::min(stable, stride / view.fastest);
  // An impact sets phyxels in relative motion that had the same velocity before.
  const double impact = impactSpeed(body, context.environment, time, std::min(left, stable), stride, view.meanSpeed);
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

BodyStepper::Advance BodyStepper::advanceExplicit(const StepContext &context, double span, std::uint64_t maxSubsteps,
                                                  const QuickCheckResult &check) {
  Body &body = *body_;
  double left = span, time = context.time, needed = 1.0;
  std::uint64_t substeps = 0;
  body.contact.sums.begin(context.environment.obstacles.size());
  while (left > 1e-12 * span && substeps < maxSubsteps) {
    const Advance stable = maxSubstep(context, time, left, substeps == 0 ? &check : nullptr);
    if (!stable) return stable;
    needed = std::max(needed, substeps_.requiredPieces(span, *stable));
    const double piece = substeps_.nextSubstep(left, span, *stable);
    explicitSubstep(body, context.environment, time, piece);
    left -= piece;
    time += piece;
    ++substeps;
  }
  // Displacements have changed by these velocities times dt: they are finite if the velocities are.
  bool finite = true;
  context.environment.clock->measure(kGuard, [&] { finite = isFinite(body.state().velocities); });
  if (!finite) return refused(firstNonFinite(body));
  substeps_.end(needed);
  const double advanced = left > 1e-12 * span ? time - context.time : span;
  reportSubsteps(context, span, advanced, substeps, needed);
  return advanced;
}

void BodyStepper::reportSubsteps(const StepContext &context, double span, double advanced, std::uint64_t substeps,
                                 double needed) {
  const bool whole = !(advanced < span);
  // If the step is chosen automatically, it is that of another body.
  double own = context.world.dt > 0.0 ? span : kStepSafety * body_->stableStepAtRest();
  if (body_->isFreeRigid()) own = std::min(own, kFreeStep);
  const double expected = std::max(1.0, SubstepController::piecesOf(span, own));
  if (substeps > maxReportedSubsteps_ && static_cast<double>(substeps) > kManyMore * expected) {
    maxReportedSubsteps_ = substeps;
    context.reportEvent("substep", "body '" + body_->name() + "': a step of " + number(span) + " s was divided into " +
                                       (whole ? std::to_string(substeps) : number(needed)) + " substeps of " +
                                       number(advanced / static_cast<double>(substeps)) + " s");
  }
  if (whole || slowReported_) return;
  slowReported_ = true;
  context.reportEvent("slowed", "body '" + body_->name() + "': a step ended after " + std::to_string(substeps) +
                                    " substeps at " + number(advanced) + " s of " + number(span) +
                                    " s; time goes on by what is done in a step");
}

}  // namespace pointbased::detail
