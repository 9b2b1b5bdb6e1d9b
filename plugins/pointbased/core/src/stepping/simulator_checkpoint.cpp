// SPDX-License-Identifier: Apache-2.0
#include "stepping/simulator_checkpoint.h"

#include "base/number_text.h"
#include "stepping/attachment_layer.h"

namespace pointbased {

Checkpoint Simulator::checkpoint() const {
  auto kept = std::make_shared<detail::SimulatorCheckpoint>();
  kept->historyEpoch = historyEpoch_;
  kept->contactSwitches = contactSwitches_;
  for (const auto &[id, stepper] : bodies_) kept->bodies.emplace(id, stepper->checkpoint());
  kept->probes = probes_;
  kept->time = time_;
  kept->loadFactor = loadFactor_;
  kept->steps = steps_;
  kept->events = events_;
  kept->notRereferenced = notRereferenced_;
  kept->skinDeepest = skinDeepest_;
  kept->rigidDeepest = rigidDeepest_;
  kept->overlaps = overlaps_;
  kept->lastPair = lastPair_;
  for (const auto &[id, layer] : attachments_) kept->torn.emplace(id, layer->torn());
  kept->tornReported = tornReported_;
  kept->obstacles = obstacles_;
  kept->obstacleIds = obstacleIds_;
  kept->instruments = instruments_;
  kept->ownMotions = ownMotions_;
  for (const auto &[id, pair] : skins_->pairs()) kept->contacts.emplace(id, pair->state());
  return kept;
}

bool Simulator::restore(const Checkpoint &checkpoint) {
  if (!checkpoint || checkpoint->historyEpoch != historyEpoch_) return false;
  restoreObstacles(*checkpoint);
  for (auto &[id, stepper] : bodies_) {
    const auto found = checkpoint->bodies.find(id);
    if (found == checkpoint->bodies.end()) continue;
    stepper->restore(found->second, parallelFor_);
    // Waiting points may have waited for other obstacles.
    if (checkpoint->contactSwitches != contactSwitches_) stepper->body().contact.blocks = ContactState::Blocks();
  }
  probes_ = checkpoint->probes;
  const double from = time();
  time_ = checkpoint->time;
  loadFactor_ = checkpoint->loadFactor;
  steps_ = checkpoint->steps;
  events_ = checkpoint->events;
  notRereferenced_ = checkpoint->notRereferenced;
  skinDeepest_ = checkpoint->skinDeepest;
  rigidDeepest_ = checkpoint->rigidDeepest;
  overlaps_ = checkpoint->overlaps;
  lastPair_ = checkpoint->lastPair;
  for (const auto &[id, torn] : checkpoint->torn)
    if (const auto found = attachments_.find(id); found != attachments_.end()) (void)found->second->setTorn(torn);
  tornReported_ = checkpoint->tornReported;
  skins_->forget();
  for (const auto &[id, state] : checkpoint->contacts) {
    const Body *first = body(id.first), *second = body(id.second);
    if (first && second)
      skins_
          ->pairOf(detail::SkinContacts::ownerOf(id.first, *first, contactPairs_),
                   detail::SkinContacts::ownerOf(id.second, *second, contactPairs_), contact_.friction)
          .restore(state);
  }
  reportEvent("restored",
              "at " + detail::number(from) + " s the state of " + detail::number(time()) + " s was taken up again");
  return true;
}

}  // namespace pointbased
