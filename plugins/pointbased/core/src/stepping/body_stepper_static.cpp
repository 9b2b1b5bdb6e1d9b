// SPDX-License-Identifier: Apache-2.0
// Quasi-static increments of the load on a body.
#include <algorithm>

#include "base/number_text.h"
#include "stepping/body_stepper.h"

namespace pointbased::detail {
namespace {

constexpr int kMostHalvings = 6;  // of an increment, before a body stops

}  // namespace

void BodyStepper::loadUpTo(const StepContext &order, double factor) {
  Body &body = *body_;
  ++changes_;
  if (order.environment.stop != nullptr) underWay_ = Start{substeps_, body.state()};
  double at = order.loadFactor, size = factor - at;
  int halvings = 0;
  while (at < factor - 1e-12) {
    const double next = std::min(factor, at + size);
    body.keepState();
    body.contact.sums.begin(order.environment.obstacles.size());
    const ImplicitResult result = quasiStaticStep(body, solver_, order.environment, at, next);
    const bool finite = quickCheck(body).finite;
    if (result.failure.empty() && finite) {
      at = next;
      continue;
    }
    body.restoreState();
    solver_.forget();
    const GuardFinding finding{
        result.newton.worst, result.failure.empty() ? "the state is not finite" : result.failure,
        "more solver.load_steps, a smaller load, or solver.integrator = \"implicit\" with damping"};
    if (++halvings > kMostHalvings) return stop(order, finding);
    size *= 0.5;
    order.reportEvent("smaller_step", "body '" + body.name() + "': " + finding.quantity + "; back to load factor " +
                                          number(at) + ", with increments of " + number(size));
  }
}

}  // namespace pointbased::detail
