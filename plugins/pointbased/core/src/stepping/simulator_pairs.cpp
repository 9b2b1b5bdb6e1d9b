// SPDX-License-Identifier: Apache-2.0
// Contact pairs: their settings, and the forces between touching bodies.
#include <algorithm>
#include <cmath>

#include "base/expects.h"
#include "discretisation/interpolation_at.h"
#include "pointbased/simulator.h"
#include "stepping/body_stepper.h"
#include "stepping/contact_pressure.h"
#include "stepping/skin_contacts.h"

namespace pointbased {
namespace {

std::pair<std::size_t, std::size_t> ordered(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

// m, present distance of a contact point from the plane with which the contact was found.
double gapNow(const Body &body, const Contact &contact, double elapsed) {
  const Interpolation &binding = body.rest().contact.binding;
  const std::span<const Vec3> u = body.state().displacements;
  const Mat3 F = detail::rankOf(binding, contact.point) < 3 ? detail::gradientAt(binding, contact.point, u)
                                                            : Mat3(Mat3::Identity());
  const Vec3 x =
      body.rest().origin + binding.positions[contact.point] + detail::displacementAt(binding, contact.point, u, F);
  return contact.gap + contact.normal.dot(x - contact.place - elapsed * contact.surfaceVelocity);
}

}  // namespace

void Simulator::setContact(const ContactSettings &contact) {
  POINTBASED_EXPECTS(contact.friction >= 0.0 && std::isfinite(contact.friction),
                     "friction is finite, and not negative");
  if (contact == contact_) return;
  const bool switches = contact.enabled != contact_.enabled;
  if (switches || contact.self != contact_.self) ++contactSwitches_;
  contact_ = contact;
  for (auto &[id, stepper] : bodies_) {
    stepper->wake();
    if (!rigidTissues_.contains(id)) continue;
    updateSurroundings(id);
    if (switches) stepper->body().contact = ContactState();
  }
}

bool Simulator::exists(std::size_t id) const {
  return id == kWorldBox || bodies_.contains(id) || obstacle(id) != nullptr;
}

void Simulator::setContactPair(std::size_t a, std::size_t b, const ContactPairSettings &settings) {
  POINTBASED_EXPECTS(std::isfinite(settings.friction), "friction is finite");
  if (a == b || !exists(a) || !exists(b) || (!bodies_.contains(a) && !bodies_.contains(b))) return;
  const ContactPairSettings before = contactPair(a, b);
  contactPairs_[ordered(a, b)] = settings;
  if (before.enabled != settings.enabled) ++contactSwitches_;
  for (const std::size_t id : {a, b}) {
    const auto found = bodies_.find(id);
    if (found == bodies_.end()) continue;
    updateSurroundings(id);
    // Waiting points may have waited for other obstacles.
    if (before.enabled != settings.enabled) found->second->body().contact.blocks = ContactState::Blocks();
    found->second->wake();
  }
}

ContactPairSettings Simulator::contactPair(std::size_t a, std::size_t b) const {
  const bool bodies = bodies_.contains(a) && bodies_.contains(b);
  if (a == b || !exists(a) || !exists(b) || (!bodies_.contains(a) && !bodies_.contains(b)))
    return {contact_.friction, false};
  ContactPairSettings out{contact_.friction, bodies ? contact_.enabled : true};
  if (!bodies) {
    const std::size_t other = bodies_.contains(a) ? b : a;
    out.friction = other == kWorldBox ? world_.box.friction : obstacle(other)->friction;
  }
  if (const auto own = contactPairs_.find(ordered(a, b)); own != contactPairs_.end()) {
    if (own->second.friction >= 0.0) out.friction = own->second.friction;
    out.enabled = out.enabled && own->second.enabled;
    out.fits = bodies && own->second.fits;
  }
  return out;
}

void Simulator::updateSurroundings(std::size_t id) {
  const bool has = std::any_of(contactPairs_.begin(), contactPairs_.end(), [&](const auto &pair) {
    const auto &[a, b] = pair.first;
    return (a == id && !bodies_.contains(b)) || (b == id && !bodies_.contains(a));
  });
  const auto tissues = rigidTissues_.find(id);
  const bool meetsThem = tissues != rigidTissues_.end() && contact_.enabled;
  if (!has && !meetsThem) {
    surroundings_.erase(id);
    return;
  }
  std::vector<Obstacle> &all = surroundings_[id];
  all.clear();
  if (meetsThem) all = tissues->second;
  for (Obstacle &tissue : all) tissue.friction = contact_.friction;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const ContactPairSettings pair = contactPair(id, obstacleIds_[o]);
    Obstacle &felt = all.emplace_back(obstacles_[o]);
    felt.friction = pair.friction;
    if (pair.enabled) continue;
    felt.motion = nullptr;
    felt.closest = nullptr;
    felt.crossing = nullptr;
  }
}

void Simulator::updateSurroundings() {
  for (const auto &[id, stepper] : bodies_) updateSurroundings(id);
}

std::span<const Obstacle> Simulator::surroundingsOf(std::size_t id) const {
  const auto found = surroundings_.find(id);
  return std::span<const Obstacle>(found == surroundings_.end() ? obstacles_ : found->second);
}

std::size_t Simulator::ownObstacleCount(std::size_t id) const { return surroundingsOf(id).size() - obstacles_.size(); }

std::span<const Obstacle> Simulator::obstaclesOf(std::size_t id) const {
  return surroundingsOf(id).subspan(ownObstacleCount(id));
}

WorldBox Simulator::boxOf(std::size_t id) const {
  WorldBox box = world_.box;
  if (!surroundings_.contains(id)) return box;
  const ContactPairSettings walls = contactPair(id, kWorldBox);
  box.friction = walls.friction;
  box.enabled = box.enabled && walls.enabled;
  return box;
}

detail::StepContext Simulator::contextFor(std::size_t id, const detail::StepContext &context) const {
  detail::StepContext own = context;
  if (!surroundings_.contains(id)) return own;
  own.environment.obstacles = surroundingsOf(id);
  own.environment.box = boxOf(id);
  return own;
}

std::vector<ContactSummary> Simulator::contacts() const {
  std::vector<ContactSummary> out;
  const auto add = [&](const ContactSummary &more) {
    const auto known = std::find_if(out.begin(), out.end(), [&](const ContactSummary &one) {
      return one.first == more.first && one.second == more.second;
    });
    if (known == out.end()) return out.push_back(more);
    known->force += more.force;
    known->pressing += more.pressing;
    known->depth = std::max(known->depth, more.depth);
    known->points += more.points;
    known->area += more.area;
  };
  for (const auto &[id, stepper] : bodies_) {
    const Body &body = stepper->body();
    const ContactSums &sums = body.contact.sums;
    const std::size_t own = ownObstacleCount(id), walls = own + obstacles_.size();
    if (!(sums.span > 0.0) || sums.of.size() != walls + 1) continue;
    std::vector<ContactSummary> found(sums.of.size());
    for (std::size_t o = 0; o < found.size(); ++o) {
      found[o].first = id;
      found[o].second = o < own ? id : o < walls ? obstacleIds_[o - own] : kWorldBox;
      found[o].force = sums.of[o].impulse / sums.span;
      found[o].pressing = sums.of[o].pressing / sums.span;
    }
    // By point: one in contact with two faces of an obstacle counts once.
    std::vector<Index> last(found.size(), Contact::kWall);
    const double elapsed = clockOfRamps() - body.contact.lookedAt;
    for (const Contact &contact : body.contact.active) {
      const std::size_t o = contact.obstacle == Contact::kWall ? walls : contact.obstacle;
      found[o].depth = std::max(found[o].depth, -gapNow(body, contact, elapsed));
      if (!(contact.normalImpulse > 0.0) || last[o] == contact.point) continue;
      last[o] = contact.point;
      ++found[o].points;
      found[o].area += body.rest().contact.areas[contact.point];
    }
    for (const ContactSummary &summary : found)
      if (summary.pressing > 0.0) add(summary);
  }
  for (const auto &[id, pair] : skins_->pairs()) {
    const detail::SkinPair::Sum &sum = pair->sum();
    if (!(sum.pressing > 0.0) || !(sum.span > 0.0)) continue;
    const auto points = std::count_if(pair->active().begin(), pair->active().end(),
                                      [](const detail::SkinContact &c) { return c.normalImpulse > 0.0; });
    add({id.first, id.second, sum.impulse / sum.span, sum.pressing / sum.span, pair->depth(),
         static_cast<std::size_t>(points), detail::pressedArea(*pair)});
  }
  return out;
}

void Simulator::contactPressures(std::size_t id, std::vector<double> &out) const {
  const Body *target = body(id);
  if (!target) {
    out.clear();
    return;
  }
  detail::PressureOnSkin pressure(*target);
  pressure.addObstacles();
  for (const auto &[pair, skins] : skins_->pairs()) {
    if (pair.first == id) pressure.addSkin(*skins, 0);
    if (pair.second == id) pressure.addSkin(*skins, 1);
  }
  out = pressure.pressures();
}

}  // namespace pointbased
