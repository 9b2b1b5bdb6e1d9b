// SPDX-License-Identifier: Apache-2.0
// Quasi-static load increments of a body.
#include <algorithm>

#include "base/number_text.h"
#include "stepping/islands/island.h"

namespace pointbased::detail {
namespace {

constexpr double kMaxNormalRotation = 1e-3;  // rad: attachments whose normals have rotated by less are in equilibrium
constexpr int kMaxNormalUpdates = 20;
constexpr int kMaxHalvings = 6;  // of an increment, before a body stops
const char *const kRemedy = "more solver.load_steps, a smaller load, or solver.integrator = \"implicit\" with damping";

}  // namespace

void BodyStepper::beginLoad(const StepContext &context) {
  ++changes_;
  if (context.environment.stop != nullptr) activeStep_ = StepStart{substeps_, body_->state()};
}

void BodyStepper::loadUpTo(const StepContext &context, double factor) {
  Body &body = *body_;
  beginLoad(context);
  double at = context.loadFactor, size = factor - at;
  int halvings = 0;
  while (at < factor - 1e-12) {
    const double next = std::min(factor, at + size);
    body.keepState();
    body.contact.sums.begin(context.environment.obstacles.size());
    const ImplicitResult result = quasiStaticStep(body, solver_, context.environment, at, next);
    const bool finite = quickCheck(body).finite;
    if (result.failure.empty() && finite) {
      at = next;
      continue;
    }
    body.restoreState();
    solver_.forget();
    const GuardFinding finding{result.newton.worst, result.failure.empty() ? "the state is not finite" : result.failure,
                               kRemedy};
    if (++halvings > kMaxHalvings) return stop(context, finding);
    size *= 0.5;
    context.reportEvent("smaller_step", "body '" + body.name() + "': " + finding.quantity + "; back to load factor " +
                                            number(at) + ", with increments of " + number(size));
  }
}

void Island::loadUpTo(std::span<const StepContext> contexts, double factor) {
  double at = contexts.front().loadFactor, size = factor - at;
  int halvings = 0, updates = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) members_[k].stepper->beginLoad(contexts[k]);
  bool again = false;  // at the same load, because something has torn or rotated
  while (at < factor - 1e-12 || again) {
    gatherCoupling(contexts);
    if (parts_.empty()) return;
    const double next = again ? at : std::min(factor, at + size);
    const StageCoupling::Contacts before = coupling_.contacts();
    for (std::size_t k = 0; k < members_.size(); ++k) {
      if (!moves(k)) continue;
      members_[k].stepper->body().keepState();
      members_[k].stepper->body().contact.sums.begin(contexts[k].environment.obstacles.size());
    }
    ImplicitResult result = quasiStaticStep(parts_, &coupling_, solver_, at, next, {});
    std::size_t failed = members_.size();
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k) && !quickCheck(members_[k].stepper->body()).finite) failed = k;
    if (result.failure.empty() && failed == members_.size()) {
      at = next;
      const bool hasTorn = tearLayers(at);
      again = hasTorn || (normalRotation_ > kMaxNormalRotation && ++updates < kMaxNormalUpdates);
      if (!again) updates = 0;
      addLayerForces(at);
      continue;
    }
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k)) members_[k].stepper->body().restoreState();
    coupling_.setContacts(before);
    solver_.forget();
    const auto [worst, phyxel] = failed < members_.size() ? std::pair(failed, Index{0}) : ownerOf(result.newton.worst);
    const GuardFinding finding{phyxel, result.failure.empty() ? "the state is not finite" : result.failure, kRemedy};
    if (++halvings > kMaxHalvings) {
      members_[worst].stepper->stop(contexts[worst], finding);
      halvings = 0;
      size = factor - at;
      continue;
    }
    size *= 0.5;
    contexts[worst].reportEvent("smaller_step", "body '" + members_[worst].stepper->body().name() +
                                                    "': " + finding.quantity + "; back to load factor " + number(at) +
                                                    ", with increments of " + number(size));
  }
}

}  // namespace pointbased::detail
