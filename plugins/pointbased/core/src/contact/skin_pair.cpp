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
    : skins_{PairedSkin{&first, {}, {}}, PairedSkin{&second, {}, {}}}, settings_(settings),
      spacing_(std::min(first.spacing(), second.spacing())) {
  for (PairedSkin &side : skins_) side.isInside.assign(side.skin->skin().count(), 0);
  if (isSelf()) forecast_.emplace(first, settings.sameTissueDistance, kSelfContactReach * spacing_);
}

std::optional<bool> SkinPair::predictedContact() {
  return forecast_->isStillValid() ? std::optional<bool>(forecast_->predictsContact()) : std::nullopt;
}

bool SkinPair::recomputePredictedContact() {
  forecast_->rebuild();
  return forecast_->predictsContact();
}

void SkinPair::Travel::start(const SkinPair &pair) {
  for (std::size_t s = 0; s < 2; ++s) {
    const std::span<const Vec3> u = pair.skins_[s].skin->displacements();
    reference[s].assign(u.begin(), u.end());
    if (pair.isSelf()) break;
  }
}

double SkinPair::Travel::since(const SkinPair &pair) const {
  const MovingSkin &first = *pair.skins_[0].skin, &second = *pair.skins_[1].skin;
  Vec3 ofFirst, ofSecond;
  const double travel = first.travelSince(reference[0], ofFirst);
  return travel + (pair.isSelf() ? travel : second.travelSince(reference[1], ofSecond) + (ofFirst - ofSecond).norm());
}

// Measures travel from the vertices themselves, where the bounds from phyxels are too coarse.
void SkinPair::measureVertexTravel() {
  MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  stepTravel_ =
      first.stepTravelExact() + second.stepTravelExact() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  if (sinceList_.reference[0].empty()) return;
  std::array<Vec3, 2> means;
  travelSinceList_ = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *skins_[s].skin;
    (void)skin.travelSince(sinceList_.reference[s], means[s]);
    skin.updatePositions();
    double squared = 0.0;
    for (std::size_t v = 0; v < positionsAtListing_[s].size(); ++v)
      squared = std::max(squared, (skin.positions()[v] - positionsAtListing_[s][v] - means[s]).squaredNorm());
    travelSinceList_ += std::sqrt(squared);
  }
  travelSinceList_ += (means[0] - means[1]).norm();
}

// Same for the vertices of the candidates, since they were gathered.
void SkinPair::measureCandidateTravel(bool hasGathered) {
  std::array<Vec3, 2> means{Vec3::Zero(), Vec3::Zero()};
  double stepTravel = 0.0, candidateTravel = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *skins_[s].skin;
    if (hasGathered) (void)skin.travelSince(sinceGathered_.reference[s], means[s]);
    double farthest = 0.0, fastest = 0.0;
    for (std::size_t k = 0; k < candidateVertices_[s].size(); ++k) {
      const Index v = candidateVertices_[s][k];
      fastest = std::max(fastest, (dt_ * skin.velocity(v) - skin.meanStepTravel()).squaredNorm());
      if (hasGathered)
        farthest = std::max(farthest, (skin.position(v) - positionsAtGathering_[s][k] - means[s]).squaredNorm());
    }
    stepTravel += std::sqrt(fastest);
    candidateTravel += std::sqrt(farthest);
  }
  stepTravel_ = stepTravel + (skins_[0].skin->meanStepTravel() - skins_[1].skin->meanStepTravel()).norm();
  if (hasGathered) travelSinceGather_ = candidateTravel + (means[0] - means[1]).norm();
}

bool SkinPair::isStillValid() const {
  if (!(validTravel_ > 0.0)) return false;
  const MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  const double stepTravel =
      first.stepTravel() + second.stepTravel() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  return sinceSearch_.since(*this) + stepTravel <= validTravel_;
}

// Restarts the measurement of travel; the list keeps its remaining reach.
void SkinPair::rebasePatchPairs() {
  listReach_ -= travelSinceList_;
  for (PatchPair &pair : patchPairs_) pair.separation -= travelSinceList_;
  travelSinceList_ = 0.0;
  sinceList_.start(*this);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::span<const Vec3> x = skins_[s].skin->positions();
    positionsAtListing_[s].assign(x.begin(), x.end());
  }
}

// @return whether the gathered candidates belong to the same list
bool SkinPair::updatePatchPairs() {
  const bool isNew = sinceList_.reference[0].empty();
  if (!isNew) travelSinceList_ = sinceList_.since(*this);
  const double contactDistance = settings_.offset + settings_.margin;
  const double reuseMargin = kReuseMarginFraction * settings_.margin;
  const auto isOutdated = [&] {
    return isNew || !(travelSinceList_ + stepTravel_ + reuseMargin <= listReach_ - contactDistance);
  };
  if (!isOutdated()) return true;
  measureVertexTravel();
  const bool rebuilds = isOutdated();
  if (rebuilds) {
    listReach_ = contactDistance + reuseMargin +
                 std::max({settings_.minReach, std::min(kLookaheadSteps * stepTravel_, kMaxReach * spacing_),
                           kMinLookahead * stepTravel_});
    travelSinceList_ = 0.0;
    findPatchPairs(listReach_);
  }
  rebasePatchPairs();
  return !rebuilds;
}

bool SkinPair::updateForecast() {
  if (!forecast_->isStillValid()) forecast_->rebuild();
  if (std::exchange(forecastRevision_, forecast_->revision()) == forecast_->revision()) return true;
  patchPairs_.clear();
  for (const SkinForecast::Pair &pair : forecast_->pairs()) patchPairs_.push_back({pair.first, pair.second, 0.0});
  return false;
}

void SkinPair::find(double dt, bool isRepeat) {
  dt_ = dt;
  reducesOverlap_ = !isRepeat;
  if (reducesOverlap_) toleratedBefore_ = toleratedOverlap_;
  const MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  stepTravel_ = first.stepTravel() + second.stepTravel() + (first.meanStepTravel() - second.meanStepTravel()).norm();
  const bool hasGathered = isSelf() ? updateForecast() : updatePatchPairs();
  const double reuseMargin = kReuseMarginFraction * settings_.margin;
  std::swap(previous_, active_);
  active_.clear();
  depth_ = 0.0;
  travelSinceGather_ = hasGathered && reuseDistance_ > 0.0 && !patchPairs_.empty() ? sinceGathered_.since(*this) : 0.0;
  const auto isQuasiStatic = [this] { return stepTravel_ <= kQuasiStaticTravel * kReuseDistance * spacing_; };
  if (!isSelf() && !patchPairs_.empty() && (!isQuasiStatic() || travelSinceGather_ + stepTravel_ > reuseDistance_))
    measureCandidateTravel(hasGathered && reuseDistance_ > 0.0);
  if (!hasGathered || !(reuseDistance_ > 0.0 && travelSinceGather_ + stepTravel_ <= reuseDistance_)) {
    travelSinceGather_ = 0.0;
    reuseDistance_ = isQuasiStatic() ? kReuseDistance * spacing_ : 0.0;
    gatherCandidates();
    if (reuseDistance_ > 0.0) {
      sinceGathered_.start(*this);
      for (std::size_t s = 0; s < 2; ++s) {
        positionsAtGathering_[s].clear();
        for (const Index v : candidateVertices_[s]) positionsAtGathering_[s].push_back(skins_[s].skin->position(v));
      }
    }
  }
  relaxInitialPenetration();
  for (VertexCandidates &group : vertices_)
    if (!(group.idleTravel > travelSinceGather_ + stepTravel_)) updateVertexContact(group);
  for (EdgeCandidates &pair : edges_)
    if (!(pair.idleTravel > travelSinceGather_ + stepTravel_)) updateEdgeContact(pair);
  validTravel_ =
      isFirstSearch_ || (toleratedOverlap_ > 0.0 && resolvesInitialOverlap()) || stepKind_ != StepKind::explicitStep
          ? 0.0
          : reuseMargin;
  if (validTravel_ > 0.0) sinceSearch_.start(*this);
  if (isFirstSearch_) recordInitialPenetration();
  if (isFirstSearch_ && !resolvesInitialOverlap()) depth_ = 0.0;
  isFirstSearch_ = false;
  // Without listed patches and without vertices inside, no overlap remains.
  const auto hasInside = [](const PairedSkin &side) {
    return std::find(side.isInside.begin(), side.isInside.end(), 1) != side.isInside.end();
  };
  if (toleratedOverlap_ > 0.0 && patchPairs_.empty() && std::none_of(skins_.begin(), skins_.end(), hasInside)) {
    for (PairedSkin &side : skins_) side.initialPenetration.clear();
    toleratedOverlap_ = 0.0;
  }
  warmStartContacts();
}

void SkinPair::findPatchPairs(double reach) {
  MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  first.refitTree();
  second.refitTree();
  patchPairs_.clear();
  first.tree().visitPairsWithin(second.tree(), reach, traversalStack_, [&](Index a, Index b, double squared) {
    patchPairs_.push_back({a, b, std::sqrt(squared)});
  });
  for (std::size_t s = 0; s < 2; ++s) {
    const std::vector<PatchTree::Patch> &patches = skins_[s].skin->tree().patches();
    isListed_.assign(skins_[s].skin->skin().count(), 0);
    for (const PatchPair &pair : patchPairs_)
      for (const Index v : patches[s == 0 ? pair.first : pair.second].corners) isListed_[v] = 1;
    candidateVertices_[s].clear();
    for (Index v = 0; v < isListed_.size(); ++v)
      if (isListed_[v] != 0) candidateVertices_[s].push_back(v);
    listedCount_[s] = candidateVertices_[s].size();
  }
  if (isFirstSearch_)
    for (const std::size_t side : {0, 1}) markVerticesInside(side);
}

// Marks vertices inside the other skin at the first find(). Later this follows from the history of each vertex.
void SkinPair::markVerticesInside(std::size_t side) {
  MovingSkin &own = *skins_[side].skin, &other = *skins_[1 - side].skin;
  // Skins that fit together cross by less than an edge length. Deeper vertices are next to an open boundary of the
  // skin.
  const double deepest = resolvesInitialOverlap()
                             ? std::numeric_limits<double>::infinity()
                             : std::max({kDeepOverlap * spacing_, meanEdge(own.skin()), meanEdge(other.skin())});
  for (Index v = 0; v < own.skin().count(); ++v) {
    const Vec3 &x = own.positions()[v];
    if (!(own.skin().areas[v] > 0.0) || other.tree().bounds().squaredDistance(x) > 0.0) continue;
    const Index t = other.nearestTriangle(x);
    const NearestOnTriangle found = other.nearestOn(t, x);
    if (found.squared > deepest * deepest) continue;
    if ((x - other.pointOn(t, found.weights)).dot(other.featureNormal(t, found.feature)) < 0.0)
      skins_[side].isInside[v] = 1;
  }
}

// Gathers the pairs of vertices and triangles, and of edges, that may touch within the step.
void SkinPair::gatherCandidates() {
  vertexFacePairs_.clear();
  edges_.clear();
  MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  const double contactDistance = settings_.offset + settings_.margin;
  for (std::size_t k = 0; k < patchPairs_.size(); ++k) {
    auto &[a, b, separation] = patchPairs_[k];
    if (isSelf() ? !forecast_->mayTouch(forecast_->pairs()[k])
                 : separation - travelSinceList_ > contactDistance + reuseDistance_ + stepTravel_)
      continue;
    const MovingSkin::PatchMotion &own = first.motionOf(a), &others = second.motionOf(b);
    // Largest relative velocity of a point of one patch and a point of the other.
    const Vec3 fastest = (own.velocities.high - others.velocities.low)
                             .cwiseAbs()
                             .cwiseMax((others.velocities.high - own.velocities.low).cwiseAbs());
    const double reach = contactDistance + reuseDistance_ + (1.0 + kSpeedMargin) * dt_ * fastest.norm();
    double distance = std::sqrt(own.positions.squaredDistance(others.positions));
    if (distance <= reach)
      distance = std::max({distance, first.distance(a, second.slabOf(b)), second.distance(b, first.slabOf(a))});
    separation = distance - travelSinceList_;
    if (!(distance <= reach)) continue;
    gatherVertices(false, a, b, reach);
    gatherVertices(!isSelf(), b, a, reach);
    gatherEdges(a, b, reach);
  }
  const auto before = [](const VertexFacePair &a, const VertexFacePair &b) {
    return std::tuple(a.ofSecond, a.vertex, a.triangle) < std::tuple(b.ofSecond, b.vertex, b.triangle);
  };
  std::sort(vertexFacePairs_.begin(), vertexFacePairs_.end(), before);
  if (!isSelf()) {
    const std::size_t count = vertexFacePairs_.size();
    for (const std::size_t s : {0, 1}) candidateVertices_[s].resize(listedCount_[s]);
    for (const bool ofSecond : {false, true}) addDeepVertices(ofSecond);
    if (vertexFacePairs_.size() > count) std::sort(vertexFacePairs_.begin(), vertexFacePairs_.end(), before);
  }
  constexpr double kNow = -std::numeric_limits<double>::infinity();
  vertices_.clear();
  for (std::size_t begin = 0, end = 0; begin < vertexFacePairs_.size(); begin = end) {
    while (end < vertexFacePairs_.size() && vertexFacePairs_[end].isOf(vertexFacePairs_[begin])) ++end;
    vertices_.push_back({begin, end, kNow});
  }
  std::sort(edges_.begin(), edges_.end(), [](const EdgeCandidates &a, const EdgeCandidates &b) {
    return std::tuple(a.first, a.second) < std::tuple(b.first, b.second);
  });
}

// Vertices deep inside have no candidates within reach: they get the nearest triangle.
void SkinPair::addDeepVertices(bool ofSecond) {
  MovingSkin &own = *skins_[ofSecond ? 1 : 0].skin, &other = *skins_[ofSecond ? 0 : 1].skin;
  const std::vector<std::uint8_t> &isInside = skins_[ofSecond ? 1 : 0].isInside;
  const std::size_t count = vertexFacePairs_.size();
  for (Index v = 0; v < isInside.size(); ++v) {
    if (isInside[v] == 0) continue;
    const auto end = vertexFacePairs_.begin() + static_cast<std::ptrdiff_t>(count);
    const auto found = std::lower_bound(vertexFacePairs_.begin(), end, v, [&](const VertexFacePair &one, Index vertex) {
      return std::tuple(one.ofSecond, one.vertex) < std::tuple(ofSecond, vertex);
    });
    if (found != end && found->vertex == v && found->ofSecond == ofSecond) continue;
    other.refitTree();
    const Vec3 x = own.position(v);
    const Index t = other.nearestTriangle(x);
    vertexFacePairs_.push_back({v, t, ofSecond});
    candidateVertices_[ofSecond ? 1 : 0].push_back(v);
    for (const Index corner : other.skin().triangles[t]) candidateVertices_[ofSecond ? 0 : 1].push_back(corner);
  }
}

void SkinPair::gatherVertices(bool ofSecond, Index patch, Index otherPatch, double reach) {
  MovingSkin &own = *skins_[ofSecond ? 1 : 0].skin, &other = *skins_[ofSecond ? 0 : 1].skin;
  const SkinBox around = other.motionOf(otherPatch).positions.expanded(reach);
  const MovingSkin::Slab &slab = other.slabOf(otherPatch);
  const std::vector<Vec3> &rest = own.skin().vertices.positions;
  const std::vector<Index> &triangles = other.tree().patches()[otherPatch].triangles;
  const MovingSkin::PatchFeatures &features = featuresOf(ofSecond ? 0 : 1, otherPatch);
  for (const Index v : own.tree().patches()[patch].vertices) {
    const Vec3 &x = own.position(v);
    if (!around.overlaps({x, x}) || slab.distance(x) > reach) continue;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      if (!(features.triangles[k].squaredDistance(x) <= reach * reach)) continue;
      const Index t = triangles[k];
      const auto &[a, b, c] = other.skin().triangles[t];
      if (isSelf() && (a == v || b == v || c == v)) continue;
      const NearestOnTriangle found = other.nearestOn(t, x);
      if (!(found.squared <= reach * reach)) continue;
      if (isSelf() &&
          areSameTissue(rest[v], found.weights[0] * rest[a] + found.weights[1] * rest[b] + found.weights[2] * rest[c]))
        continue;
      vertexFacePairs_.push_back({v, t, ofSecond});
    }
  }
}

void SkinPair::gatherEdges(Index patch, Index otherPatch, double reach) {
  MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  const SkinBox around = second.motionOf(otherPatch).positions.expanded(reach);
  const MovingSkin::PatchFeatures &otherFeatures = featuresOf(1, otherPatch);
  for (const auto &[e, ownBox] : featuresOf(0, patch).edges) {
    if (!around.overlaps(ownBox)) continue;
    const SkinBox box = ownBox.expanded(reach);
    for (const auto &[f, otherBox] : otherFeatures.edges) {
      if (!box.overlaps(otherBox)) continue;
      const std::array<Index, 2> &ends = first.skin().edges[e].ends, &otherEnds = second.skin().edges[f].ends;
      if (isSelf() && (share(ends, otherEnds) || areSameTissue(ends, otherEnds))) continue;
      edges_.push_back(
          {isSelf() ? std::min(e, f) : e, isSelf() ? std::max(e, f) : f, -std::numeric_limits<double>::infinity()});
    }
  }
}

const MovingSkin::PatchFeatures &SkinPair::featuresOf(std::size_t side, Index patch) const {
  MovingSkin &skin = *skins_[side].skin;
  return skin.featuresOf(patch, kSharpEdgeSine, kSharpEdgeRise * settings_.offset);
}

bool SkinPair::areSameTissue(const Vec3 &a, const Vec3 &b) const {
  return isSelf() && (a - b).squaredNorm() <= settings_.sameTissueDistance * settings_.sameTissueDistance;
}

bool SkinPair::areSameTissue(const std::array<Index, 2> &edge, const std::array<Index, 2> &other) const {
  const std::vector<Vec3> &rest = skins_[0].skin->skin().vertices.positions;
  for (const Index a : edge)
    for (const Index b : other)
      if (!areSameTissue(rest[a], rest[b])) return false;
  return true;
}

void SkinPair::restore(const State &state) {
  active_ = state.active;
  for (std::size_t s = 0; s < 2; ++s) {
    skins_[s].initialPenetration = state.initialPenetrations[s];
    skins_[s].isInside = state.isInside[s];
  }
  toleratedOverlap_ = state.toleratedOverlap;
  isFirstSearch_ = false;
  sinceList_.clear();
  if (forecast_) forecast_->invalidate();
  sum_ = Sum();
  sinceSearch_.reference = state.displacementsAtSearch;
  validTravel_ = state.validTravel;
}

void SkinPair::addToSum(double dt) {
  sum_.duration += dt;
  for (const SkinContact &contact : active_) {
    if (!(contact.normalImpulse > 0.0)) continue;
    const double normal = contact.normalImpulse + contact.projectionImpulse;
    sum_.impulse += normal * contact.normal + contact.frictionImpulse + contact.projectionFriction;
    sum_.normalImpulseSum += normal;
  }
}

void SkinPair::warmStartContacts() {
  std::size_t from = 0;
  for (SkinContact &contact : active_) {
    while (from < previous_.size() && previous_[from].key < contact.key) ++from;
    if (from < previous_.size() && previous_[from].key == contact.key) warmStartFrom(previous_[from], contact);
  }
}

}  // namespace pointbased::detail
