// SPDX-License-Identifier: Apache-2.0
#include "pointbased/state_archive.h"

#include "base/number_text.h"
#include "stepping/simulation/simulator_checkpoint.h"

namespace pointbased {

Checkpoint StateArchive::checkpoint() const {
  auto kept = std::make_shared<detail::SimulatorCheckpoint>();
  kept->historyEpoch = state_.historyEpoch;
  kept->contactSwitches = state_.contact.switches;
  for (const auto &[id, stepper] : state_.bodies) kept->bodies.emplace(id, stepper->checkpoint());
  kept->probes = state_.probes;
  kept->progress = state_.progress;
  kept->events = state_.events;
  kept->reported = state_.reported;
  for (const auto &[id, layer] : state_.attachments) kept->torn.emplace(id, layer->torn());
  kept->obstacles = state_.obstacles;
  for (const auto &[id, pair] : state_.skins.pairs()) kept->contacts.emplace(id, pair->state());
  return kept;
}

bool StateArchive::restore(const Checkpoint &checkpoint) {
  if (!checkpoint || checkpoint->historyEpoch != state_.historyEpoch) return false;
  // Within a history epoch: only instruments, and the motions of all obstacles, may differ.
  const detail::ObstacleSet &kept = checkpoint->obstacles;
  for (const std::size_t id : std::set<std::size_t>(state_.obstacles.instruments))
    if (!kept.instruments.contains(id)) state_.removeObstacle(id);
  state_.obstacles = kept;
  for (std::size_t o = 0; o < kept.all.size(); ++o) state_.setMotion(kept.ids[o], kept.all[o].motion);
  for (auto &[id, stepper] : state_.bodies) {
    const auto found = checkpoint->bodies.find(id);
    if (found == checkpoint->bodies.end()) continue;
    stepper->restore(found->second, state_.parallelFor);
    // Waiting points may have waited for other obstacles.
    if (checkpoint->contactSwitches != state_.contact.switches) stepper->body().contact.blocks = ContactState::Blocks();
  }
  state_.probes = checkpoint->probes;
  const double from = state_.time();
  state_.progress = checkpoint->progress;
  state_.events = checkpoint->events;
  state_.reported = checkpoint->reported;
  for (const auto &[id, torn] : checkpoint->torn)
    if (const auto found = state_.attachments.find(id); found != state_.attachments.end())
      (void)found->second->setTorn(torn);
  state_.skins.clear();
  for (const auto &[id, state] : checkpoint->contacts) {
    const Body *first = state_.body(id.first), *second = state_.body(id.second);
    if (first && second)
      state_.skins
          .pairOf(detail::SkinContacts::ownerOf(id.first, *first, state_.contact.pairs),
                  detail::SkinContacts::ownerOf(id.second, *second, state_.contact.pairs),
                  state_.contact.settings.friction)
          .restore(state);
  }
  state_.reportEvent("restored", "at " + detail::number(from) + " s the state of " + detail::number(state_.time()) +
                                     " s was taken up again");
  return true;
}

std::uint64_t StateArchive::historyEpoch() const { return state_.historyEpoch; }

}  // namespace pointbased
