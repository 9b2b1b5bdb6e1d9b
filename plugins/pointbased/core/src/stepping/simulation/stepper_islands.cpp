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

/// The bodies of a step, joined where they may touch or are attached: its connected components are the islands.
class IslandGraph {
 public:
  struct Node {
    std::size_t id;
    BodyStepper *stepper;
    bool idle;  ///< static, stopped or asleep: two of them are not joined
    Box box;    ///< that it may reach within the step
  };

  void add(const Node &node, bool touchesItself) {
    if (touchesItself) pairs_.emplace_back(nodes_.size(), nodes_.size());
    nodes_.push_back(node);
  }
  /// Its bodies are joined; nodes that are not added yet are unknown.
  void attach(AttachmentLayer &layer) {
    attached_.push_back({&layer, numberOf(layer.settings().first), numberOf(layer.settings().second)});
  }
  /// Joins nodes of which the boxes overlap.
  template <class CanTouch>
  void joinOverlapping(const CanTouch &canTouch) {
    for (std::size_t a = 0; a < nodes_.size(); ++a)
      for (std::size_t b = a + 1; b < nodes_.size(); ++b)
        if (!(nodes_[a].idle && nodes_[b].idle) && nodes_[a].box.overlaps(nodes_[b].box) &&
            canTouch(nodes_[a].id, nodes_[b].id))
          pairs_.emplace_back(a, b);
  }
  /// @param pairOf  the contact pair of two nodes
  template <class PairOf>
  void build(IslandSet &islands, const PairOf &pairOf) const {
    DisjointSets sets(nodes_.size());
    std::vector<std::uint8_t> joined(nodes_.size(), 0);
    const auto join = [&](std::size_t a, std::size_t b) {
      joined[a] = 1;
      if (b == JoinedLayer::kNoBody) return;
      joined[b] = 1;
      sets.join(a, b);
    };
    for (const JoinedLayer &one : attached_) join(one.first, one.second);
    for (const auto &[a, b] : pairs_) join(a, b);

    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> islandOfRoot(nodes_.size(), kNone), memberOf(nodes_.size());
    const auto islandOf = [&](std::size_t k) -> Island & { return *islands.list[islandOfRoot[sets.find(k)]]; };
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (!joined[k]) continue;
      std::size_t &number = islandOfRoot[sets.find(k)];
      if (number == kNone) {
        number = islands.count++;
        if (islands.list.size() < islands.count) islands.list.push_back(std::make_unique<Island>());
        islands.list[number]->clear();
      }
      memberOf[k] = islandOf(k).members().size();
      islandOf(k).add(nodes_[k].id, *nodes_[k].stepper);
      islands.members.insert(nodes_[k].id);
    }
    for (const JoinedLayer &one : attached_)
      islandOf(one.first).attach({one.layer, memberOf[one.first],
                                  one.second == JoinedLayer::kNoBody ? JoinedLayer::kNoBody : memberOf[one.second]});
    for (const auto &[a, b] : pairs_) islandOf(a).join(pairOf(nodes_[a], nodes_[b]), memberOf[a], memberOf[b]);
  }

 private:
  [[nodiscard]] std::size_t numberOf(std::size_t id) const {
    const auto found = std::find_if(nodes_.begin(), nodes_.end(), [id](const Node &one) { return one.id == id; });
    return found == nodes_.end() ? JoinedLayer::kNoBody : static_cast<std::size_t>(found - nodes_.begin());
  }

  std::vector<Node> nodes_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  ///< equal indices: contact with itself
  std::vector<JoinedLayer> attached_;                       ///< bodies by index among the nodes
};

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
  const auto predictContact = [&]() -> bool {
    // Load increments have no velocities: the next one is assumed to be like the last one.
    const State &state = body.state();
    std::vector<Vec3> ofLoad;
    if (state_.quasiStatic()) ofLoad = lastIncrement(body);
    const auto move = [&](SkinPair &pair) {
      pair.moving(0).move(state.displacements, state_.quasiStatic() ? ofLoad : state.velocities,
                          body.rest().maxInfluence, state_.quasiStatic() ? 1.0 : dt);
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
  };
  bool isPredicted = false;
  state_.clock.measure(kContact, [&] { isPredicted = predictContact(); });
  return isPredicted;
}

void Stepper::buildIslands(double dt) {
  IslandSet &islands = state_.islands;
  islands.count = 0;
  islands.members.clear();
  for (auto &[id, stepper] : state_.bodies)
    if (!stepper->asleep()) stepper->setSharedIntegrator(std::nullopt);
  state_.skins.beginSums([this](std::size_t id) {
    const BodyStepper &stepper = *state_.bodies.at(id);
    return stepper.asleep() || stepper.stopped() || stepper.body().isStatic();
  });
  const bool isEnabled = state_.contact.settings.enabled && (state_.bodies.size() > 1 || state_.contact.settings.self);
  const bool hasPairs = isEnabled && state_.bodies.size() > 1;
  islands.touchThemselves.clear();
  for (auto &[id, stepper] : state_.bodies)
    if (isEnabled && mayTouchItself(id, dt)) islands.touchThemselves.insert(id);
  if (!hasPairs && islands.touchThemselves.empty() && state_.attachments.empty()) return;
  const auto boxOf = [&](const Body &body) {
    if (!hasPairs) return Box();
    return state_.quasiStatic() ? reachOfIncrement(body) : reachOf(body, state_.settings.gravity, dt);
  };
  IslandGraph graph;
  for (auto &[id, stepper] : state_.bodies) {
    if (!SkinContacts::hasSkin(stepper->body())) continue;
    const bool isStatic = stepper->stopped() || stepper->body().isStatic();
    graph.add({id, stepper.get(), isStatic || stepper->asleep(), boxOf(stepper->body())},
              islands.touchThemselves.contains(id));
  }
  for (const auto &[id, layer] : state_.attachments) graph.attach(*layer);
  if (hasPairs) graph.joinOverlapping([this](std::size_t a, std::size_t b) { return world_.canTouch(a, b); });
  graph.build(islands, [this](const IslandGraph::Node &a, const IslandGraph::Node &b) -> SkinPair & {
    const ContactPairSettings both = state_.contactPair(a.id, b.id);
    const auto owner = [this](const IslandGraph::Node &one) {
      return SkinContacts::ownerOf(one.id, one.stepper->body(), state_.contact.pairs);
    };
    return state_.skins.pairOf(owner(a), owner(b), both.friction, both.fits);
  });
}

}  // namespace pointbased
