// SPDX-License-Identifier: Apache-2.0
// Contact of pairs: their settings, and the obstacles as each body sees them.
#include <algorithm>
#include <cmath>

#include "base/expects.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

std::pair<std::size_t, std::size_t> ordered(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

bool exists(const detail::SimulationState &state, std::size_t id) {
  return id == kWorldBox || state.bodies.contains(id) || state.obstacle(id) != nullptr;
}

}  // namespace

void World::setContact(const ContactSettings &contact) {
  POINTBASED_EXPECTS(contact.friction >= 0.0 && std::isfinite(contact.friction),
                     "friction is finite, and not negative");
  if (contact == state_.contact.settings) return;
  const bool switches = contact.enabled != state_.contact.settings.enabled;
  if (switches || contact.self != state_.contact.settings.self) ++state_.contact.switches;
  state_.contact.settings = contact;
  for (auto &[id, stepper] : state_.bodies) {
    stepper->wake();
    if (!state_.contact.rigidTissues.contains(id)) continue;
    state_.updateSurroundings(id);
    if (switches) stepper->body().contact = ContactState();
  }
}

void World::setContactPair(std::size_t a, std::size_t b, const ContactPairSettings &settings) {
  POINTBASED_EXPECTS(std::isfinite(settings.friction), "friction is finite");
  if (a == b || !exists(state_, a) || !exists(state_, b) || (!state_.bodies.contains(a) && !state_.bodies.contains(b)))
    return;
  const ContactPairSettings before = state_.contactPair(a, b);
  state_.contact.pairs[ordered(a, b)] = settings;
  if (before.enabled != settings.enabled) ++state_.contact.switches;
  for (const std::size_t id : {a, b}) {
    const auto found = state_.bodies.find(id);
    if (found == state_.bodies.end()) continue;
    state_.updateSurroundings(id);
    // Waiting points may have waited for other obstacles.
    if (before.enabled != settings.enabled) found->second->body().contact.blocks = ContactState::Blocks();
    found->second->wake();
  }
}

const ContactSettings &World::contact() const { return state_.contact.settings; }
const ContactPairs &World::contactPairs() const { return state_.contact.pairs; }
ContactPairSettings World::contactPair(std::size_t a, std::size_t b) const { return state_.contactPair(a, b); }

bool World::canTouch(std::size_t a, std::size_t b) const {
  if (!detail::SkinContacts::hasSkin(state_.bodies.at(a)->body()) ||
      !detail::SkinContacts::hasSkin(state_.bodies.at(b)->body()))
    return false;
  return a == b ? state_.contact.settings.enabled && state_.contact.settings.self : state_.contactPair(a, b).enabled;
}

std::span<const Obstacle> World::obstaclesOf(std::size_t id) const {
  return state_.surroundingsOf(id).subspan(state_.ownObstacleCount(id));
}

WorldBox World::boxOf(std::size_t id) const {
  WorldBox box = state_.settings.box;
  if (!state_.contact.surroundings.contains(id)) return box;
  const ContactPairSettings walls = state_.contactPair(id, kWorldBox);
  box.friction = walls.friction;
  box.enabled = box.enabled && walls.enabled;
  return box;
}

ContactPairSettings detail::SimulationState::contactPair(std::size_t a, std::size_t b) const {
  const bool bothBodies = bodies.contains(a) && bodies.contains(b);
  if (a == b || !exists(*this, a) || !exists(*this, b) || (!bodies.contains(a) && !bodies.contains(b)))
    return {contact.settings.friction, false};
  ContactPairSettings out{contact.settings.friction, bothBodies ? contact.settings.enabled : true};
  if (!bothBodies) {
    const std::size_t other = bodies.contains(a) ? b : a;
    out.friction = other == kWorldBox ? settings.box.friction : obstacle(other)->friction;
  }
  if (const auto own = contact.pairs.find(ordered(a, b)); own != contact.pairs.end()) {
    if (own->second.friction >= 0.0) out.friction = own->second.friction;
    out.enabled = out.enabled && own->second.enabled;
    out.fits = bothBodies && own->second.fits;
  }
  return out;
}

void detail::SimulationState::updateSurroundings(std::size_t id) {
  const bool has = std::any_of(contact.pairs.begin(), contact.pairs.end(), [&](const auto &pair) {
    const auto &[a, b] = pair.first;
    return (a == id && !bodies.contains(b)) || (b == id && !bodies.contains(a));
  });
  const auto tissues = contact.rigidTissues.find(id);
  const bool meetsThem = tissues != contact.rigidTissues.end() && contact.settings.enabled;
  if (!has && !meetsThem) {
    contact.surroundings.erase(id);
    return;
  }
  std::vector<Obstacle> &all = contact.surroundings[id];
  all.clear();
  if (meetsThem) all = tissues->second;
  for (Obstacle &tissue : all) tissue.friction = contact.settings.friction;
  for (std::size_t o = 0; o < obstacles.all.size(); ++o) {
    const ContactPairSettings pair = contactPair(id, obstacles.ids[o]);
    Obstacle &felt = all.emplace_back(obstacles.all[o]);
    felt.friction = pair.friction;
    if (pair.enabled) continue;
    felt.motion = nullptr;
    felt.closest = nullptr;
    felt.crossing = nullptr;
  }
}

void detail::SimulationState::updateSurroundings() {
  for (const auto &[id, stepper] : bodies) updateSurroundings(id);
}

std::span<const Obstacle> detail::SimulationState::surroundingsOf(std::size_t id) const {
  const auto found = contact.surroundings.find(id);
  return std::span<const Obstacle>(found == contact.surroundings.end() ? obstacles.all : found->second);
}

std::size_t detail::SimulationState::ownObstacleCount(std::size_t id) const {
  return surroundingsOf(id).size() - obstacles.all.size();
}

}  // namespace pointbased
