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

constexpr double kBoxMargin = 0.5;          // spacings
constexpr double kIncrementFraction = 0.1;  // of a body's size, permitted travel in a load increment
constexpr double kSpeedFactor = 2.0;        // times the travel of a step: bodies may gain speed within it

// Bounding box of a body, widened by its possible travel within a step.
Box reachOf(const Body &body, const Vec3 &gravity, double dt) {
  Box box;
  double speed = 0.0;
  const RestState &rest = body.rest();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    box.add(Vec3(rest.origin + rest.positions[i] + body.state().displacements[i]));
    speed = std::max(speed, body.state().velocities[i].squaredNorm());
  }
  return box.expanded(kSpeedFactor * dt * (std::sqrt(speed) + dt * gravity.norm()) + kBoxMargin * rest.spacing);
}

// m/s, upper bound of the speed of the skin vertices, relative to a rigid motion of the body.
double deformingSpeed(const Body &body, const SkinContacts::SelfContactBound &bound) {
  const RestState &rest = body.rest();
  const State &state = body.state();
  const double count = static_cast<double>(std::max<std::size_t>(1, rest.phyxelCount()));
  Vec3 centre = Vec3::Zero(), velocity = Vec3::Zero();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    centre += rest.positions[i] + state.displacements[i];
    velocity += state.velocities[i];
  }
  centre /= count;
  velocity /= count;
  const auto arm = [&](std::size_t i) -> Vec3 { return rest.positions[i] + state.displacements[i] - centre; };
  Mat3 inertia = Mat3::Zero();
  Vec3 spin = Vec3::Zero();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 r = arm(i);
    inertia += r.squaredNorm() * Mat3::Identity() - r * r.transpose();
    spin += r.cross(state.velocities[i] - velocity);
  }
  // Collinear points have no inertia about their line.
  inertia += 1e-9 * inertia.trace() * Mat3::Identity();
  const Vec3 angularVelocity = inertia.trace() > 0.0 ? Vec3(inertia.ldlt().solve(spin)) : Vec3(Vec3::Zero());
  TravelBound fastest(rest.maxInfluence);
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    fastest.add(i, state.velocities[i] - velocity - angularVelocity.cross(arm(i)));
  return bound.vertexBound(fastest);
}

// m, displacement of each phyxel in the last load increment; zero before the first one.
std::vector<Vec3> lastIncrement(const Body &body) {
  const std::vector<Vec3> &before = body.savedStateCopy().displacements, &now = body.state().displacements;
  std::vector<Vec3> displacements(now.size(), Vec3::Zero());
  if (before.size() == now.size())
    for (std::size_t i = 0; i < now.size(); ++i) displacements[i] = now[i] - before[i];
  return displacements;
}

// m, largest of them.
double incrementTravel(const Body &body) {
  double travel = 0.0;
  for (const Vec3 &one : lastIncrement(body)) travel = std::max(travel, one.norm());
  return travel;
}

// Same travel as in the last load increment, plus a fraction of the body's size, because there is none before the
// first.
Box reachOfIncrement(const Body &body) {
  Box box;
  const double travel = incrementTravel(body);
  const RestState &rest = body.rest();
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i)
    box.add(Vec3(rest.origin + rest.positions[i] + body.state().displacements[i]));
  return box.expanded(kSpeedFactor * travel + kBoxMargin * rest.spacing +
                      kIncrementFraction * (box.high - box.low).norm());
}

}  // namespace

// A skin can touch itself only after phyxels have moved relative to each other by the clearance of its parts.
bool Stepper::mayTouchItself(std::size_t id, double dt) {
  const Body &body = state_.bodies.at(id)->body();
  if (body.rigid() || state_.bodies.at(id)->stopped() || state_.bodies.at(id)->asleep() || !world_.canTouch(id, id))
    return false;
  SkinContacts::SelfContactBound *bound = &state_.skins.selfContactBound(id, body);
  const QuickCheckResult check = quickCheck(body);
  if (!check.finite) return false;
  double travel =
      2.0 * kSpeedFactor * bound->gain * (state_.quasiStatic() ? incrementTravel(body) : dt * check.speedBound);
  bound->clearance -= travel;
  if (bound->clearance > 0.0) return false;
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
    if (const std::optional<bool> predicted = own->predictedContact()) return *predicted;
  }
  const SkinContacts::Owner owner = SkinContacts::ownerOf(id, body, state_.contact.pairs);
  const auto isClear = [&] {
    bound->measure(state.displacements);
    if (!state_.quasiStatic()) travel = 2.0 * kSpeedFactor * dt * deformingSpeed(body, *bound);
    bound->clearance -= travel;
    return bound->clearance > 0.0;
  };
  if (isClear()) return false;
  if (bound->skin == nullptr) {
    bound = &state_.skins.measuredSelfContactBound(owner);
    if (isClear()) return false;
  }
  if (!bound->isResolved()) {
    monitor_->reportUnresolvedThickness(id, bound->thickness);
    bound->clearance = std::numeric_limits<double>::infinity();
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
    if (!stepper->asleep()) stepper->setSharedIntegrator(std::nullopt);
  state_.skins.beginSums([this](std::size_t id) {
    const BodyStepper &stepper = *state_.bodies.at(id);
    return stepper.asleep() || stepper.stopped() || stepper.body().isStatic();
  });
  const bool isEnabled = state_.contact.settings.enabled && (state_.bodies.size() > 1 || state_.contact.settings.self);
  state_.islands.touchThemselves.clear();
  for (auto &[id, stepper] : state_.bodies)
    if (isEnabled && mayTouchItself(id, dt)) state_.islands.touchThemselves.insert(id);
  if (!(isEnabled && state_.bodies.size() > 1) && state_.islands.touchThemselves.empty() && state_.attachments.empty())
    return;
  struct Candidate {
    std::size_t id;
    BodyStepper *stepper;
    bool idle;
    Box box;
  };
  std::vector<Candidate> candidates;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (auto &[id, stepper] : state_.bodies) {
    if (!SkinContacts::hasSkin(stepper->body())) continue;
    const bool isStatic = stepper->stopped() || stepper->body().isStatic();
    if (state_.islands.touchThemselves.contains(id)) pairs.emplace_back(candidates.size(), candidates.size());
    candidates.push_back({id, stepper.get(), isStatic || stepper->asleep(), {}});
    if (!isEnabled || state_.bodies.size() < 2) continue;
    candidates.back().box = state_.quasiStatic() ? reachOfIncrement(stepper->body())
                                                 : reachOf(stepper->body(), state_.settings.gravity, dt);
  }
  DisjointSets sets(candidates.size());
  std::vector<JoinedLayer> held;  // by indices of ones
  const auto numberOfBody = [&](std::size_t id) {
    const auto found =
        std::find_if(candidates.begin(), candidates.end(), [id](const Candidate &one) { return one.id == id; });
    return found == candidates.end() ? JoinedLayer::kNoBody : static_cast<std::size_t>(found - candidates.begin());
  };
  std::vector<std::uint8_t> joined(candidates.size(), 0);
  for (const auto &[id, layer] : state_.attachments) {
    held.push_back({layer.get(), numberOfBody(layer->settings().first), numberOfBody(layer->settings().second)});
    joined[held.back().first] = 1;
    if (held.back().second == JoinedLayer::kNoBody) continue;
    joined[held.back().second] = 1;
    sets.join(held.back().first, held.back().second);
  }
  for (std::size_t a = 0; isEnabled && a < candidates.size(); ++a)
    for (std::size_t b = a + 1; b < candidates.size(); ++b) {
      if ((candidates[a].idle && candidates[b].idle) || !candidates[a].box.overlaps(candidates[b].box) ||
          !world_.canTouch(candidates[a].id, candidates[b].id))
        continue;
      pairs.emplace_back(a, b);
      sets.join(a, b);
    }
  for (const auto &[a, b] : pairs) joined[a] = joined[b] = 1;
  std::vector<std::size_t> islandOf(candidates.size(), std::numeric_limits<std::size_t>::max()),
      numberOf(candidates.size());
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const std::size_t root = sets.find(k);
    if (!joined[k]) continue;
    std::size_t &island = islandOf[root];
    if (island == std::numeric_limits<std::size_t>::max()) {
      island = state_.islands.count++;
      if (state_.islands.list.size() < state_.islands.count) state_.islands.list.push_back(std::make_unique<Island>());
      state_.islands.list[island]->clear();
    }
    numberOf[k] = state_.islands.list[island]->members().size();
    state_.islands.list[island]->add(candidates[k].id, *candidates[k].stepper);
    state_.islands.members.insert(candidates[k].id);
  }
  for (const JoinedLayer &one : held)
    state_.islands.list[islandOf[sets.find(one.first)]]->attach(
        {one.layer, numberOf[one.first],
         one.second == JoinedLayer::kNoBody ? JoinedLayer::kNoBody : numberOf[one.second]});
  for (const auto &[a, b] : pairs) {
    const ContactPairSettings both = state_.contactPair(candidates[a].id, candidates[b].id);
    const auto owner = [&](std::size_t k) {
      return SkinContacts::ownerOf(candidates[k].id, candidates[k].stepper->body(), state_.contact.pairs);
    };
    SkinPair &pair = state_.skins.pairOf(owner(a), owner(b), both.friction, both.fits);
    state_.islands.list[islandOf[sets.find(a)]]->join(pair, numberOf[a], numberOf[b]);
  }
}

}  // namespace pointbased
