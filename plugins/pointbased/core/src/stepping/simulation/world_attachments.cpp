// SPDX-License-Identifier: Apache-2.0
// Elastic layers between bodies, obstacles and surroundings.
#include "base/number_text.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {

using namespace detail;

namespace {

// Wider gaps are spanned by extrapolation far from the body.
constexpr double kWideGap = 2.0;  // spacings of the second body

}  // namespace

Result<std::size_t> World::addAttachment(const Attachment &attachment) {
  const Body *first = state_.body(attachment.first), *second = state_.body(attachment.second);
  const Obstacle *other = attachment.second == kSurroundings || second ? nullptr : state_.obstacle(attachment.second);
  if (!first) return tl::make_unexpected(std::string("what is attached is no body of this simulation"));
  if (first == second) return tl::make_unexpected(std::string("a body cannot be attached to itself"));
  if (attachment.second != kSurroundings && !second && !other)
    return tl::make_unexpected(std::string("a body is attached to something that is not in this simulation"));
  auto layer = AttachmentLayer::make(attachment, *first, second, other);
  if (!layer) return tl::unexpected(layer.error());
  state_.reset();
  const std::size_t id = state_.nextId++;
  if (second && layer->maxGap() > kWideGap * second->rest().spacing)
    state_.addWarning(
        id, "attachment '" + attachment.name + "' spans gaps of up to " + number(1e3 * layer->maxGap()) +
                " mm, where the spacing of body '" + second->name() + "' is " + number(1e3 * second->rest().spacing) +
                " mm: what moves there is continued far, and small turns of the surface pull much; a smaller " +
                "within_mm helps");
  state_.attachments.emplace(id, std::make_unique<AttachmentLayer>(std::move(*layer)));
  state_.updateAttachments();
  for (auto &[number, stepper] : state_.bodies) stepper->wake();
  return id;
}

bool World::removeAttachment(std::size_t id) { return state_.removeAttachment(id); }

std::vector<AttachmentSummary> World::attachments() const {
  std::vector<AttachmentSummary> out;
  for (const auto &[id, layer] : state_.attachments) {
    out.push_back(layer->summary(state_.attachedState(*layer)));
    out.back().id = id;
  }
  return out;
}

bool SimulationState::removeAttachment(std::size_t id) {
  if (attachments.erase(id) == 0) return false;
  ++historyEpoch;
  warnings.erase(id);
  reported.torn.erase(id);
  updateAttachments();
  for (auto &[number, stepper] : bodies) stepper->wake();
  return true;
}

void SimulationState::removeAttachmentsOf(std::size_t id) {
  std::vector<std::size_t> advanced;
  for (const auto &[number, layer] : attachments)
    if (layer->settings().first == id || layer->settings().second == id) advanced.push_back(number);
  for (const std::size_t number : advanced) (void)removeAttachment(number);
}

void SimulationState::updateAttachments() {
  std::map<std::size_t, double> squared;
  for (const auto &[number, layer] : attachments) {
    const Body *first = body(layer->settings().first), *second = body(layer->settings().second);
    const auto massesOf = [](const Body *one) {
      return one && !one->isStatic() ? one->inverseMasses() : std::span<const double>();
    };
    const double bound = layer->squaredFrequencyBound(massesOf(first), massesOf(second));
    for (const Body *one : {first, second})
      if (one && !one->isStatic()) squared[one == first ? layer->settings().first : layer->settings().second] += bound;
  }
  for (auto &[id, stepper] : bodies) {
    const auto found = squared.find(id);
    stepper->body().setAttachedFrequency(found == squared.end() ? 0.0 : found->second);
    if (found != squared.end()) stepper->body().forcesCurrent = false;
  }
}

AttachmentLayer::AttachedState SimulationState::attachedState(const AttachmentLayer &layer) const {
  const Body *first = body(layer.settings().first), *second = body(layer.settings().second);
  AttachmentLayer::AttachedState sides{first->state().displacements, {}, rampTime()};
  if (second) sides.second = second->state().displacements;
  return sides;
}

}  // namespace pointbased
