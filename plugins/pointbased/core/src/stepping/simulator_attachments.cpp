// SPDX-License-Identifier: Apache-2.0
// Elastic layers between bodies, obstacles and surroundings.
#include <algorithm>

#include "base/number_text.h"
#include "pointbased/simulator.h"
#include "stepping/attachment_layer.h"
#include "stepping/body_stepper.h"

namespace pointbased {

using namespace detail;

namespace {

// Wider gaps are spanned by extrapolation far from the body.
constexpr double kWideGap = 2.0;  // spacings of the second body

AttachmentLayer::Sides sidesOf(const Simulator &simulator, const AttachmentLayer &layer) {
  const Body *first = simulator.body(layer.settings().first), *second = simulator.body(layer.settings().second);
  AttachmentLayer::Sides sides{
      first->state().displacements, {}, simulator.quasiStatic() ? simulator.loadFactor() : simulator.time()};
  if (second) sides.second = second->state().displacements;
  return sides;
}

}  // namespace

Result<std::size_t> Simulator::addAttachment(const Attachment &attachment) {
  const Body *first = body(attachment.first), *second = body(attachment.second);
  const Obstacle *other = attachment.second == kSurroundings || second ? nullptr : obstacle(attachment.second);
  if (!first) return tl::make_unexpected(std::string("what is attached is no body of this simulation"));
  if (first == second) return tl::make_unexpected(std::string("a body cannot be attached to itself"));
  if (attachment.second != kSurroundings && !second && !other)
    return tl::make_unexpected(std::string("a body is attached to something that is not in this simulation"));
  auto layer = AttachmentLayer::make(attachment, *first, second, other);
  if (!layer) return tl::unexpected(layer.error());
  reset();
  const std::size_t id = nextId_++;
  if (second && layer->widest() > kWideGap * second->rest().spacing)
    addWarning(id, "attachment '" + attachment.name + "' spans gaps of up to " + number(1e3 * layer->widest()) +
                       " mm, where the spacing of body '" + second->name() + "' is " +
                       number(1e3 * second->rest().spacing) +
                       " mm: what moves there is continued far, and small turns of the surface pull much; a smaller " +
                       "within_mm helps");
  attachments_.emplace(id, std::make_unique<AttachmentLayer>(std::move(*layer)));
  updateAttachments();
  for (auto &[number, stepper] : bodies_) stepper->wake();
  return id;
}

bool Simulator::removeAttachment(std::size_t id) {
  if (attachments_.erase(id) == 0) return false;
  ++historyEpoch_;
  warnings_.erase(id);
  tornReported_.erase(id);
  updateAttachments();
  for (auto &[number, stepper] : bodies_) stepper->wake();
  return true;
}

void Simulator::removeAttachmentsOf(std::size_t id) {
  std::vector<std::size_t> advanced;
  for (const auto &[number, layer] : attachments_)
    if (layer->settings().first == id || layer->settings().second == id) advanced.push_back(number);
  for (const std::size_t number : advanced) (void)removeAttachment(number);
}

void Simulator::updateAttachments() {
  std::map<std::size_t, double> squared;
  for (const auto &[number, layer] : attachments_) {
    const Body *first = body(layer->settings().first), *second = body(layer->settings().second);
    const auto massesOf = [](const Body *one) {
      return one && !one->isStatic() ? one->inverseMasses() : std::span<const double>();
    };
    const double bound = layer->squaredFrequencyBound(massesOf(first), massesOf(second));
    for (const Body *one : {first, second})
      if (one && !one->isStatic()) squared[one == first ? layer->settings().first : layer->settings().second] += bound;
  }
  for (auto &[id, stepper] : bodies_) {
    const auto found = squared.find(id);
    stepper->body().setAttachedFrequency(found == squared.end() ? 0.0 : found->second);
    if (found != squared.end()) stepper->body().forcesCurrent = false;
  }
}

double Simulator::attachedEnergy(std::size_t id) const {
  double sum = 0.0;
  for (const auto &[number, layer] : attachments_) {
    const Attachment &of = layer->settings();
    if (of.first == id || of.second == id)
      sum += (layer->joinsBodies() ? 0.5 : 1.0) * layer->energy(sidesOf(*this, *layer));
  }
  return sum;
}

std::vector<AttachmentSummary> Simulator::attachments() const {
  std::vector<AttachmentSummary> out;
  for (const auto &[id, layer] : attachments_) {
    out.push_back(layer->summary(sidesOf(*this, *layer)));
    out.back().id = id;
  }
  return out;
}

void Simulator::reportTornAttachments() {
  for (const auto &[id, layer] : attachments_) {
    if (layer->torn().empty() || tornReported_.contains(id)) continue;
    tornReported_.insert(id);
    reportEvent("torn", "attachment '" + layer->settings().name + "' has begun to tear: it pulls with more than " +
                            number(layer->settings().tearsAt) + " Pa");
  }
}

}  // namespace pointbased
