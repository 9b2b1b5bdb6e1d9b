// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "contact/contact_search.h"
#include "contact/contact_tolerances.h"

namespace pointbased::detail {
namespace {

bool share(const std::array<Index, 2> &a, const std::array<Index, 2> &b) {
  return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
}

// m, at rest; 0: the skin has no edges
double meanEdge(const ContactSkin &skin) {
  double sum = 0.0;
  for (const SkinEdge &edge : skin.edges)
    sum += (skin.vertices.positions[edge.ends[1]] - skin.vertices.positions[edge.ends[0]]).norm();
  return skin.edges.empty() ? 0.0 : sum / static_cast<double>(skin.edges.size());
}

}  // namespace

SkinPair::SkinPair(MovingSkin &first, MovingSkin &second, const SkinPairSettings &settings)
    : sides_{Side{&first, {}, {}}, Side{&second, {}, {}}}, settings_(settings),
      spacing_(std::min(first.spacing(), second.spacing())) {
  for (Side &side : sides_) side.isInside.assign(side.skin->skin().count(), 0);
  if (isSelf()) forecast_.emplace(first, settings.apart, kNearOfSelf * spacing_);
}

std::optional<bool> SkinPair::predictedContact() {
  return forecast_->isStillValid() ? std::optional<bool>(forecast_->meets()) : std::nullopt;
}

bool SkinPair::mayTouch() {
  forecast_->look();
  return forecast_->meets();
}

void SkinPair::Travel::begin(const SkinPair &pair) {
  for (std::size_t s = 0; s < 2; ++s) {
    const std::span<const Vec3> u = pair.sides_[s].skin->displacements();
    from[s].assign(u.begin(), u.end());
    if (pair.isSelf()) break;
  }
}

double SkinPair::Travel::since(const SkinPair &pair) const {
  const MovingSkin &first = *pair.sides_[0].skin, &second = *pair.sides_[1].skin;
  Vec3 ofFirst, ofSecond;
  const double went = first.travelSince(from[0], ofFirst);
  return went + (pair.isSelf() ? went : second.travelSince(from[1], ofSecond) + (ofFirst - ofSecond).norm());
}

// Measures travel from the vertices themselves, where the bounds from phyxels are too coarse.
void SkinPair::measureExactly() {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  stepTravel_ =
      first.stepTravelExact() + second.stepTravelExact() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  if (sinceList_.from[0].empty()) return;
  std::array<Vec3, 2> means;
  travelSinceList_ = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *sides_[s].skin;
    (void)skin.travelSince(sinceList_.from[s], means[s]);
    skin.placeVertices();
    double squared = 0.0;
    for (std::size_t v = 0; v < listedAt_[s].size(); ++v)
      squared = std::max(squared, (skin.positions()[v] - listedAt_[s][v] - means[s]).squaredNorm());
    travelSinceList_ += std::sqrt(squared);
  }
  travelSinceList_ += (means[0] - means[1]).norm();
}

// Same for the vertices of the candidates, since they were gathered.
void SkinPair::measureGathered(bool hasGathered) {
  std::array<Vec3, 2> means{Vec3::Zero(), Vec3::Zero()};
  double stepTravel = 0.0, moved = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *sides_[s].skin;
    if (hasGathered) (void)skin.travelSince(sinceGathered_.from[s], means[s]);
    double farthest = 0.0, fastest = 0.0;
    for (std::size_t k = 0; k < gatheredOf_[s].size(); ++k) {
      const Index v = gatheredOf_[s][k];
      fastest = std::max(fastest, (dt_ * skin.velocity(v) - skin.meanStepTravel()).squaredNorm());
      if (hasGathered) farthest = std::max(farthest, (skin.position(v) - gatheredAt_[s][k] - means[s]).squaredNorm());
    }
    stepTravel += std::sqrt(fastest);
    moved += std::sqrt(farthest);
  }
  stepTravel_ = stepTravel + (sides_[0].skin->meanStepTravel() - sides_[1].skin->meanStepTravel()).norm();
  if (hasGathered) travelSinceGather_ = moved + (means[0] - means[1]).norm();
}

bool SkinPair::isStillValid() const {
  if (!(validTravel_ > 0.0)) return false;
  const MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const double stepTravel =
      first.stepTravel() + second.stepTravel() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  return sinceFound_.since(*this) + stepTravel <= validTravel_;
}

// Restarts the measurement of travel; the list keeps its remaining reach.
void SkinPair::keepList() {
  listReach_ -= travelSinceList_;
  for (NearPatches &pair : listed_) pair.apart -= travelSinceList_;
  travelSinceList_ = 0.0;
  sinceList_.begin(*this);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::span<const Vec3> x = sides_[s].skin->positions();
    listedAt_[s].assign(x.begin(), x.end());
  }
}

// @return whether the gathered candidates belong to the same list
bool SkinPair::renewList() {
  const bool isNew = sinceList_.from[0].empty();
  if (!isNew) travelSinceList_ = sinceList_.since(*this);
  const double room = settings_.offset + settings_.margin;
  const double reuseMargin = kReuseMarginFraction * settings_.margin;
  const auto isOld = [&] { return isNew || !(travelSinceList_ + stepTravel_ + reuseMargin <= listReach_ - room); };
  if (!isOld()) return true;
  measureExactly();
  const bool lists = isOld();
  if (lists) {
    listReach_ = room + reuseMargin +
                 std::max({settings_.leastReach, std::min(kLookaheadSteps * stepTravel_, kMaxReach * spacing_),
                           kMinLookahead * stepTravel_});
    travelSinceList_ = 0.0;
    list(listReach_);
  }
  keepList();
  return !lists;
}

bool SkinPair::renewForecast() {
  if (!forecast_->isStillValid()) forecast_->look();
  if (std::exchange(forecastOf_, forecast_->number()) == forecast_->number()) return true;
  listed_.clear();
  for (const SkinForecast::Pair &pair : forecast_->pairs()) listed_.push_back({pair.first, pair.second, 0.0});
  return false;
}

void SkinPair::find(double dt, bool again) {
  dt_ = dt;
  eases_ = !again;
  if (eases_) before_ = allowed_;
  const MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  stepTravel_ = first.stepTravel() + second.stepTravel() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  const bool hasGathered = isSelf() ? renewForecast() : renewList();
  const double reuseMargin = kReuseMarginFraction * settings_.margin;
  std::swap(previous_, active_);
  active_.clear();
  depth_ = 0.0;
  travelSinceGather_ = hasGathered && reuseDistance_ > 0.0 && !listed_.empty() ? sinceGathered_.since(*this) : 0.0;
  const auto isCalm = [this] { return stepTravel_ <= kQuasiStaticTravel * kReuseDistance * spacing_; };
  if (!isSelf() && !listed_.empty() && (!isCalm() || travelSinceGather_ + stepTravel_ > reuseDistance_))
    measureGathered(hasGathered && reuseDistance_ > 0.0);
  if (!hasGathered || !(reuseDistance_ > 0.0 && travelSinceGather_ + stepTravel_ <= reuseDistance_)) {
    travelSinceGather_ = 0.0;
    reuseDistance_ = isCalm() ? kReuseDistance * spacing_ : 0.0;
    gatherCandidates();
    if (reuseDistance_ > 0.0) {
      sinceGathered_.begin(*this);
      for (std::size_t s = 0; s < 2; ++s) {
        gatheredAt_[s].clear();
        for (const Index v : gatheredOf_[s]) gatheredAt_[s].push_back(sides_[s].skin->position(v));
      }
    }
  }
  relaxInitialPenetration();
  for (VertexCandidates &group : vertices_)
    if (!(group.wake > travelSinceGather_ + stepTravel_)) updateVertexContact(group);
  for (EdgeCandidates &pair : edges_)
    if (!(pair.wake > travelSinceGather_ + stepTravel_)) updateEdgeContact(pair);
  validTravel_ = isFirst_ || (allowed_ > 0.0 && resolvesInitialOverlap()) || steps_ != Steps::small ? 0.0 : reuseMargin;
  if (validTravel_ > 0.0) sinceFound_.begin(*this);
  if (isFirst_) recordInitialPenetration();
  if (isFirst_ && !resolvesInitialOverlap()) depth_ = 0.0;
  isFirst_ = false;
  // Without listed patches and without vertices inside, no overlap remains.
  const auto hasInside = [](const Side &side) {
    return std::find(side.isInside.begin(), side.isInside.end(), 1) != side.isInside.end();
  };
  if (allowed_ > 0.0 && listed_.empty() && std::none_of(sides_.begin(), sides_.end(), hasInside)) {
    for (Side &side : sides_) side.initialPenetration.clear();
    allowed_ = 0.0;
  }
  carryImpulsesOver();
}

void SkinPair::list(double reach) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  first.placeAll();
  second.placeAll();
  listed_.clear();
  first.tree().near(second.tree(), reach, open_, [&](Index a, Index b, double squared) {
    listed_.push_back({a, b, std::sqrt(squared)});
  });
  for (std::size_t s = 0; s < 2; ++s) {
    const std::vector<PatchTree::Patch> &patches = sides_[s].skin->tree().patches();
    isListed_.assign(sides_[s].skin->skin().count(), 0);
    for (const NearPatches &pair : listed_)
      for (const Index v : patches[s == 0 ? pair.first : pair.second].corners) isListed_[v] = 1;
    gatheredOf_[s].clear();
    for (Index v = 0; v < isListed_.size(); ++v)
      if (isListed_[v] != 0) gatheredOf_[s].push_back(v);
    listedCount_[s] = gatheredOf_[s].size();
  }
  if (isFirst_)
    for (const std::size_t side : {0, 1}) findInside(side);
}

// Marks vertices inside the other skin at the first find(). Later this follows from the history of each vertex.
void SkinPair::findInside(std::size_t side) {
  MovingSkin &own = *sides_[side].skin, &other = *sides_[1 - side].skin;
  // Skins that fit together cross by less than an edge length. Vertices that seem deeper are next to a rim.
  const double deepest = resolvesInitialOverlap()
                             ? std::numeric_limits<double>::infinity()
                             : std::max({kDeep * spacing_, meanEdge(own.skin()), meanEdge(other.skin())});
  for (Index v = 0; v < own.skin().count(); ++v) {
    const Vec3 &x = own.positions()[v];
    if (!(own.skin().areas[v] > 0.0) || other.tree().bounds().squaredDistance(x) > 0.0) continue;
    const Index t = other.nearestTriangle(x);
    const NearestOnTriangle found = other.nearestOn(t, x);
    if (found.squared > deepest * deepest) continue;
    if ((x - other.pointOn(t, found.weights)).dot(other.outwardAt(t, found.feature)) < 0.0)
      sides_[side].isInside[v] = 1;
  }
}

// Gathers the pairs of vertices and triangles, and of edges, that may touch within the step.
void SkinPair::gatherCandidates() {
  near_.clear();
  edges_.clear();
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const double room = settings_.offset + settings_.margin;
  for (std::size_t k = 0; k < listed_.size(); ++k) {
    auto &[a, b, apart] = listed_[k];
    if (isSelf() ? !forecast_->mayMeet(forecast_->pairs()[k])
                 : apart - travelSinceList_ > room + reuseDistance_ + stepTravel_)
      continue;
    const MovingSkin::PatchMotion &mine = first.motionOf(a), &theirs = second.motionOf(b);
    // Largest relative velocity of a point of one patch and a point of the other.
    const Vec3 fastest = (mine.velocities.high - theirs.velocities.low)
                             .cwiseAbs()
                             .cwiseMax((theirs.velocities.high - mine.velocities.low).cwiseAbs());
    const double reach = room + reuseDistance_ + (1.0 + kSpeedMargin) * dt_ * fastest.norm();
    double distance = std::sqrt(mine.places.squaredDistance(theirs.places));
    if (distance <= reach)
      distance = std::max({distance, first.distance(a, second.slabOf(b)), second.distance(b, first.slabOf(a))});
    apart = distance - travelSinceList_;
    if (!(distance <= reach)) continue;
    gatherVertices(false, a, b, reach);
    gatherVertices(!isSelf(), b, a, reach);
    gatherEdges(a, b, reach);
  }
  const auto before = [](const Near &a, const Near &b) {
    return std::tuple(a.ofSecond, a.vertex, a.triangle) < std::tuple(b.ofSecond, b.vertex, b.triangle);
  };
  std::sort(near_.begin(), near_.end(), before);
  if (!isSelf()) {
    const std::size_t had = near_.size();
    for (const std::size_t s : {0, 1}) gatheredOf_[s].resize(listedCount_[s]);
    for (const bool ofSecond : {false, true}) addDeepVertices(ofSecond);
    if (near_.size() > had) std::sort(near_.begin(), near_.end(), before);
  }
  constexpr double kNow = -std::numeric_limits<double>::infinity();
  vertices_.clear();
  for (std::size_t begin = 0, end = 0; begin < near_.size(); begin = end) {
    while (end < near_.size() && near_[end].isOf(near_[begin])) ++end;
    vertices_.push_back({begin, end, kNow});
  }
  std::sort(edges_.begin(), edges_.end(), [](const EdgeCandidates &a, const EdgeCandidates &b) {
    return std::tuple(a.first, a.second) < std::tuple(b.first, b.second);
  });
}

// Vertices deep inside have no candidates within reach: they get the nearest triangle.
void SkinPair::addDeepVertices(bool ofSecond) {
  MovingSkin &own = *sides_[ofSecond ? 1 : 0].skin, &other = *sides_[ofSecond ? 0 : 1].skin;
  const std::vector<std::uint8_t> &isInside = sides_[ofSecond ? 1 : 0].isInside;
  const std::size_t had = near_.size();
  for (Index v = 0; v < isInside.size(); ++v) {
    if (isInside[v] == 0) continue;
    const auto end = near_.begin() + static_cast<std::ptrdiff_t>(had);
    const auto found = std::lower_bound(near_.begin(), end, v, [&](const Near &one, Index vertex) {
      return std::tuple(one.ofSecond, one.vertex) < std::tuple(ofSecond, vertex);
    });
    if (found != end && found->vertex == v && found->ofSecond == ofSecond) continue;
    other.placeAll();
    const Vec3 x = own.position(v);
    const Index t = other.nearestTriangle(x);
    near_.push_back({v, t, ofSecond});
    gatheredOf_[ofSecond ? 1 : 0].push_back(v);
    for (const Index corner : other.skin().triangles[t]) gatheredOf_[ofSecond ? 0 : 1].push_back(corner);
  }
}

void SkinPair::gatherVertices(bool ofSecond, Index patch, Index otherPatch, double reach) {
  MovingSkin &own = *sides_[ofSecond ? 1 : 0].skin, &other = *sides_[ofSecond ? 0 : 1].skin;
  const SkinBox around = other.motionOf(otherPatch).places.wider(reach);
  const MovingSkin::Slab &slab = other.slabOf(otherPatch);
  const std::vector<Vec3> &rest = own.skin().vertices.positions;
  const std::vector<Index> &triangles = other.tree().patches()[otherPatch].triangles;
  const MovingSkin::PatchParts &parts = partsOf(ofSecond ? 0 : 1, otherPatch);
  for (const Index v : own.tree().patches()[patch].vertices) {
    const Vec3 &x = own.position(v);
    if (!around.meets({x, x}) || slab.distance(x) > reach) continue;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      if (!(parts.triangles[k].squaredDistance(x) <= reach * reach)) continue;
      const Index t = triangles[k];
      const auto &[a, b, c] = other.skin().triangles[t];
      if (isSelf() && (a == v || b == v || c == v)) continue;
      const NearestOnTriangle found = other.nearestOn(t, x);
      if (!(found.squared <= reach * reach)) continue;
      if (isSelf() &&
          areOnePiece(rest[v], found.weights[0] * rest[a] + found.weights[1] * rest[b] + found.weights[2] * rest[c]))
        continue;
      near_.push_back({v, t, ofSecond});
    }
  }
}

void SkinPair::gatherEdges(Index patch, Index otherPatch, double reach) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const SkinBox around = second.motionOf(otherPatch).places.wider(reach);
  const MovingSkin::PatchParts &others = partsOf(1, otherPatch);
  for (const auto &[e, own] : partsOf(0, patch).edges) {
    if (!around.meets(own)) continue;
    const SkinBox box = own.wider(reach);
    for (const auto &[f, theirs] : others.edges) {
      if (!box.meets(theirs)) continue;
      const std::array<Index, 2> &ends = first.skin().edges[e].ends, &otherEnds = second.skin().edges[f].ends;
      if (isSelf() && (share(ends, otherEnds) || areOnePiece(ends, otherEnds))) continue;
      edges_.push_back(
          {isSelf() ? std::min(e, f) : e, isSelf() ? std::max(e, f) : f, -std::numeric_limits<double>::infinity()});
    }
  }
}

const MovingSkin::PatchParts &SkinPair::partsOf(std::size_t side, Index patch) const {
  MovingSkin &skin = *sides_[side].skin;
  return skin.partsOf(patch, kSharp, kRise * settings_.offset);
}

bool SkinPair::areOnePiece(const Vec3 &a, const Vec3 &b) const {
  return isSelf() && (a - b).squaredNorm() <= settings_.apart * settings_.apart;
}

bool SkinPair::areOnePiece(const std::array<Index, 2> &edge, const std::array<Index, 2> &other) const {
  const std::vector<Vec3> &rest = sides_[0].skin->skin().vertices.positions;
  for (const Index a : edge)
    for (const Index b : other)
      if (!areOnePiece(rest[a], rest[b])) return false;
  return true;
}

void SkinPair::restore(const State &state) {
  active_ = state.active;
  for (std::size_t s = 0; s < 2; ++s) {
    sides_[s].initialPenetration = state.initialPenetrations[s];
    sides_[s].isInside = state.isInside[s];
  }
  allowed_ = state.allowed;
  isFirst_ = false;
  sinceList_.forget();
  if (forecast_) forecast_->forget();
  sum_ = Sum();
  sinceFound_.from = state.foundAt;
  validTravel_ = state.validTravel;
}

void SkinPair::addToSum(double dt) {
  sum_.span += dt;
  for (const SkinContact &contact : active_) {
    if (!(contact.normalImpulse > 0.0)) continue;
    const double normal = contact.normalImpulse + contact.settleImpulse;
    sum_.impulse += normal * contact.normal + contact.frictionImpulse + contact.settleFriction;
    sum_.pressing += normal;
  }
}

void SkinPair::carryImpulsesOver() {
  std::size_t from = 0;
  for (SkinContact &contact : active_) {
    while (from < previous_.size() && previous_[from].key < contact.key) ++from;
    if (from < previous_.size() && previous_[from].key == contact.key) remember(previous_[from], contact);
  }
}

}  // namespace pointbased::detail
