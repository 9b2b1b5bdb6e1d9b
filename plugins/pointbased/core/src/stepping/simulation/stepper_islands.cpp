// SPDX-License-Identifier: Apache-2.0
// Builds the islands of a step: sets of bodies that may touch each other or are attached.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/disjoint_sets.h"
#include "contact/contact_skin.h"
#include "pointbased/stepper.h"
#include "stepping/monitoring/guard.h"
#include "stepping/simulation/step_monitor.h"

namespace pointbased {

using namespace detail;

namespace {

using Box = SkinBox;

constexpr double kSlack = 0.5;   // spacings
constexpr double kOfSize = 0.1;  // of a body's size, permitted travel in a load increment
constexpr double kFaster = 2.0;  // times the travel of a step: bodies may gain speed within it

// Bounding box of a body, widened by its possible travel within a step.
Box reachOf(const Body &body, const Vec3 &gravity, double dt) {
  Box box;
  double speed = 0.0;
  const RestState &rest = body.rest();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    box.add(Vec3(rest.origin + rest.positions[i] + body.state().displacements[i]));
    speed = std::max(speed, body.state().velocities[i].squaredNorm());
  }
  return box.expanded(kFaster * dt * (std::sqrt(speed) + dt * gravity.norm()) + kSlack * rest.spacing);
}

// m/s, upper bound of the speed of the skin vertices, relative to a rigid motion of the body.
double deformingSpeed(const Body &body, const SkinContacts::SelfContactBound &room) {
  const RestState &rest = body.rest();
  const State &state = body.state();
  const double count = static_cast<double>(std::max<std::size_t>(1, rest.phyxelCount()));
  Vec3 place = Vec3::Zero(), velocity = Vec3::Zero();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    place += rest.positions[i] + state.displacements[i];
    velocity += state.velocities[i];
  }
  place /= count;
  velocity /= count;
  const auto arm = [&](std::size_t i) -> Vec3 { return rest.positions[i] + state.displacements[i] - place; };
  Mat3 inertia = Mat3::Zero();
  Vec3 spin = Vec3::Zero();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 r = arm(i);
    inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
    spin += r.cross(state.velocities[i] - velocity);
  }
  // Collinear points have no inertia about their line.
  inertia += 1e-9 * inertia.trace() * Mat3::Identity();
  const Vec3 turning = inertia.trace() > 0.0 ? Vec3(inertia.ldlt().solve(spin)) : Vec3(Vec3::Zero());
  TravelBound fastest(rest.maxInfluence);
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    fastest.add(i, state.velocities[i] - velocity - turning.cross(arm(i)));
  return room.farthest(fastest);
}

// m, displacement of each phyxel in the last load increment; zero before the first one.
std::vector<Vec3> lastIncrement(const Body &body) {
  const std::vector<Vec3> &before = body.savedStateCopy().displacements, &now = body.state().displacements;
  std::vector<Vec3> ways(now.size(), Vec3::Zero());
  if (before.size() == now.size())
    for (std::size_t i = 0; i < now.size(); ++i) ways[i] = now[i] - before[i];
  return ways;
}

// m, largest of them.
double wayOfIncrement(const Body &body) {
  double way = 0.0;
  for (const Vec3 &one : lastIncrement(body)) way = std::max(way, one.norm());
  return way;
}

// Same travel as in the last load increment, plus a fraction of the body's size, because there is none before the
// first.
Box reachOfIncrement(const Body &body) {
  Box box;
  const double way = wayOfIncrement(body);
  const RestState &rest = body.rest();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    box.add(Vec3(rest.origin + rest.positions[i] + body.state().displacements[i]));
  return box.expanded(kFaster * way + kSlack * rest.spacing + kOfSize * (box.high - box.low).norm());
}

}  // namespace

// A skin can touch itself only after phyxels have moved relative to each other by the clearance of its parts.
bool Stepper::mayTouchItself(std::size_t id, double dt) {
  const Body &body = state_.bodies.at(id)->body();
  if (body.rigid() || state_.bodies.at(id)->stopped() || state_.bodies.at(id)->asleep() || !world_.canTouch(id, id))
    return false;
  SkinContacts::SelfContactBound *room = &state_.skins.selfContactBound(id, body);
  const QuickCheckResult glance = quickCheck(body);
  if (!glance.finite) return false;
  double goes = 2.0 * kFaster * room->gain * (state_.quasiStatic() ? wayOfIncrement(body) : dt * glance.speedBound);
  room->left -= goes;
  if (room->left > 0.0) return false;
  SkinPair *own = state_.skins.ownPair(id);
  if (own != nullptr && !own->active().empty()) return true;
  // Load increments have no velocities: the next one is assumed to be like the last one.
  const State &state = body.state();
  std::vector<Vec3> ofLoad;
  if (state_.quasiStatic()) ofLoad = lastIncrement(body);
  const auto move = [&](SkinPair &pair) {
    pair.moving(0).move(state.displacements, state_.quasiStatic() ? ofLoad : state.velocities, body.rest().maxInfluence,
                        state_.quasiStatic() ? 1.0 : dt);
  };
  if (own != nullptr) {
    move(*own);
    if (const std::optional<bool> told = own->predictedContact()) return *told;
  }
  const SkinContacts::Owner owner = SkinContacts::ownerOf(id, body, state_.contact.pairs);
  const auto hasRoom = [&] {
    room->measure(state.displacements);
    if (!state_.quasiStatic()) goes = 2.0 * kFaster * dt * deformingSpeed(body, *room);
    room->left -= goes;
    return room->left > 0.0;
  };
  if (hasRoom()) return false;
  if (room->skin == nullptr) {
    room = &state_.skins.measuredSelfContactBound(owner);
    if (hasRoom()) return false;
  }
  if (!room->isResolved()) {
    monitor_->reportUnresolvedThickness(id, room->thickness);
    room->left = std::numeric_limits<double>::infinity();
    return false;
  }
  SkinPair &pair = state_.skins.pairOf(owner, owner, state_.contact.settings.friction);
  move(pair);
  return pair.recomputePredictedContact();
}

void Stepper::buildIslands(double dt) {
  state_.islands.count = 0;
  state_.islands.members.clear();
  for (auto &[id, stepper] : state_.bodies)
    if (!stepper->asleep()) stepper->share(std::nullopt);
  state_.skins.beginSums([this](std::size_t id) {
    const BodyStepper &stepper = *state_.bodies.at(id);
    return stepper.asleep() || stepper.stopped() || stepper.body().isStatic();
  });
  const bool touch = state_.contact.settings.enabled && (state_.bodies.size() > 1 || state_.contact.settings.self);
  state_.islands.touchThemselves.clear();
  for (auto &[id, stepper] : state_.bodies)
    if (touch && mayTouchItself(id, dt)) state_.islands.touchThemselves.insert(id);
  if (!(touch && state_.bodies.size() > 1) && state_.islands.touchThemselves.empty() && state_.attachments.empty())
    return;
  struct One {
    std::size_t id;
    BodyStepper *stepper;
    bool idle;
    Box box;
  };
  std::vector<One> ones;
  std::vector<std::pair<std::size_t, std::size_t>> near;
  for (auto &[id, stepper] : state_.bodies) {
    if (!SkinContacts::hasSkin(stepper->body())) continue;
    const bool stands = stepper->stopped() || stepper->body().isStatic();
    if (state_.islands.touchThemselves.contains(id)) near.emplace_back(ones.size(), ones.size());
    ones.push_back({id, stepper.get(), stands || stepper->asleep(), {}});
    if (!touch || state_.bodies.size() < 2) continue;
    ones.back().box = state_.quasiStatic() ? reachOfIncrement(stepper->body())
                                           : reachOf(stepper->body(), state_.settings.gravity, dt);
  }
  DisjointSets sets(ones.size());
  std::vector<JoinedLayer> held;  // by indices of ones
  const auto numberOfBody = [&](std::size_t id) {
    const auto found = std::find_if(ones.begin(), ones.end(), [id](const One &one) { return one.id == id; });
    return found == ones.end() ? JoinedLayer::kNobody : static_cast<std::size_t>(found - ones.begin());
  };
  std::vector<std::uint8_t> joined(ones.size(), 0);
  for (const auto &[id, layer] : state_.attachments) {
    held.push_back({layer.get(), numberOfBody(layer->settings().first), numberOfBody(layer->settings().second)});
    joined[held.back().first] = 1;
    if (held.back().second == JoinedLayer::kNobody) continue;
    joined[held.back().second] = 1;
    sets.join(held.back().first, held.back().second);
  }
  for (std::size_t a = 0; touch && a < ones.size(); ++a)
    for (std::size_t b = a + 1; b < ones.size(); ++b) {
      if ((ones[a].idle && ones[b].idle) || !ones[a].box.overlaps(ones[b].box) ||
          !world_.canTouch(ones[a].id, ones[b].id))
        continue;
      near.emplace_back(a, b);
      sets.join(a, b);
    }
  for (const auto &[a, b] : near) joined[a] = joined[b] = 1;
  std::vector<std::size_t> islandOf(ones.size(), std::numeric_limits<std::size_t>::max()), numberOf(ones.size());
  for (std::size_t k = 0; k < ones.size(); ++k) {
    const std::size_t root = sets.find(k);
    if (!joined[k]) continue;
    std::size_t &island = islandOf[root];
    if (island == std::numeric_limits<std::size_t>::max()) {
      island = state_.islands.count++;
      if (state_.islands.list.size() < state_.islands.count) state_.islands.list.push_back(std::make_unique<Island>());
      state_.islands.list[island]->clear();
    }
    numberOf[k] = state_.islands.list[island]->members().size();
    state_.islands.list[island]->add(ones[k].id, *ones[k].stepper);
    state_.islands.members.insert(ones[k].id);
  }
  for (const JoinedLayer &one : held)
    state_.islands.list[islandOf[sets.find(one.first)]]->attach(
        {one.layer, numberOf[one.first],
         one.second == JoinedLayer::kNobody ? JoinedLayer::kNobody : numberOf[one.second]});
  for (const auto &[a, b] : near) {
    const ContactPairSettings both = state_.contactPair(ones[a].id, ones[b].id);
    const auto owner = [&](std::size_t k) {
      return SkinContacts::ownerOf(ones[k].id, ones[k].stepper->body(), state_.contact.pairs);
    };
    SkinPair &pair = state_.skins.pairOf(owner(a), owner(b), both.friction, both.fits);
    state_.islands.list[islandOf[sets.find(a)]]->join(pair, numberOf[a], numberOf[b]);
  }
}

}  // namespace pointbased
