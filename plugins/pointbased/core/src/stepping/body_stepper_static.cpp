// SPDX-License-Identifier: Apache-2.0
// Quasi-static increments of the load on a body.
#include <algorithm>

#include "base/number_text.h"
#include "stepping/body_group.h"

namespace pointbased::detail {
namespace {

constexpr double kTurned = 1e-3;  // rad: attachments whose normals have turned by less are in balance
constexpr int kMostTurns = 20;
constexpr int kMostHalvings = 6;  // of an increment, before a body stops
const char *const kRemedy = "more solver.load_steps, a smaller load, or solver.integrator = \"implicit\" with damping";

}  // namespace

void BodyStepper::beginLoad(const StepContext &order) {
  ++changes_;
  if (order.environment.stop != nullptr) underWay_ = Start{substeps_, body_->state()};
}

void BodyStepper::loadUpTo(const StepContext &order, double factor) {
  Body &body = *body_;
  beginLoad(order);
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
    const GuardFinding finding{result.newton.worst, result.failure.empty() ? "the state is not finite" : result.failure,
                               kRemedy};
    if (++halvings > kMostHalvings) return stop(order, finding);
    size *= 0.5;
    order.reportEvent("smaller_step", "body '" + body.name() + "': " + finding.quantity + "; back to load factor " +
                                          number(at) + ", with increments of " + number(size));
  }
}

void BodyGroup::loadUpTo(std::span<const StepContext> orders, double factor) {
  double at = orders.front().loadFactor, size = factor - at;
  int halvings = 0, turns = 0;
  for (std::size_t k = 0; k < members_.size(); ++k)
    if (moves(k)) members_[k].runner->beginLoad(orders[k]);
  bool again = false;  // at the same load, because something has torn or turned
  while (at < factor - 1e-12 || again) {
    gatherCoupling(orders);
    if (parts_.empty()) return;
    const double next = again ? at : std::min(factor, at + size);
    const StageCoupling::Contacts before = coupling_.contacts();
    for (std::size_t k = 0; k < members_.size(); ++k) {
      if (!moves(k)) continue;
      members_[k].runner->body().keepState();
      members_[k].runner->body().contact.sums.begin(orders[k].environment.obstacles.size());
    }
    ImplicitResult result = quasiStaticStep(parts_, &coupling_, solver_, at, next, {});
    std::size_t bad = members_.size();
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k) && !quickCheck(members_[k].runner->body()).finite) bad = k;
    if (result.failure.empty() && bad == members_.size()) {
      at = next;
      const bool hasTorn = tearLayers(at);
      again = hasTorn || (turned_ > kTurned && ++turns < kMostTurns);
      if (!again) turns = 0;
      addLayerForces(at);
      continue;
    }
    for (std::size_t k = 0; k < members_.size(); ++k)
      if (moves(k)) members_[k].runner->body().restoreState();
    coupling_.setContacts(before);
    solver_.forget();
    const auto [worst, phyxel] = bad < members_.size() ? std::pair(bad, Index{0}) : ownerOf(result.newton.worst);
    const GuardFinding finding{phyxel, result.failure.empty() ? "the state is not finite" : result.failure, kRemedy};
    if (++halvings > kMostHalvings) {
      members_[worst].runner->stop(orders[worst], finding);
      halvings = 0;
      size = factor - at;
      continue;
    }
    size *= 0.5;
    orders[worst].reportEvent("smaller_step", "body '" + members_[worst].runner->body().name() +
                                                  "': " + finding.quantity + "; back to load factor " + number(at) +
                                                  ", with increments of " + number(size));
  }
}

}  // namespace pointbased::detail
