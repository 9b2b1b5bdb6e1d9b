// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "contact/contact_search.h"

namespace pointbased::detail {
namespace {

// kLookaheadSteps: steps of travel covered by a list of patches. More: longer lists, built less often.
// kMaxReach: spacings, upper limit of that distance. Larger: longer lists, built less often.
// kMinLookahead: steps of travel covered at least, beyond kMaxReach if necessary. More: longer lists of fast bodies.
constexpr double kLookaheadSteps = 12.0, kMaxReach = 1.0, kMinLookahead = 2.0;
// Spacings: deeper overlap counts only for vertices that were inside before. Smaller: overlap of fast bodies is missed.
constexpr double kDeep = 0.1;
// kSharp: sine of the angle between two faces. Flatter edges are smooth and left to the vertices; larger: fewer edges.
// kRise: of the offset: an edge that rises farther along its length is tested, however smooth; larger: fewer edges.
constexpr double kSharp = 0.05, kRise = 0.05;
// Of the relative travel of a step: extra distance between fast skins. Residual velocity of the solver and contact
// planes frozen at the beginning of the step then cause no tunnelling. Larger: safer, fast skins stay farther apart.
constexpr double kSpeedMargin = 0.1;
// kCone: sine, tolerance of the cone of directions that leave an edge. Larger: edges past their cone count as contacts.
// kEnds: of an edge, length at both ends that does not belong to its interior. It absorbs rounding.
constexpr double kCone = 0.05, kEnds = 1e-6;
// Cosine: contacts of a vertex with normals closer than that are one side. Larger: more contacts per vertex.
constexpr double kOneSide = 0.7;
// Sine of the angle between a face and the edge to a neighbour of a vertex: a steeper neighbour reaches the plane of the
// face first. Larger: fewer vertices are skipped.
constexpr double kBehind = 0.65;
// Cosine between facing and contact normal, for a skin with itself: sides must face each other. Larger: more contacts.
constexpr double kFacing = -0.2;
// kReuseDistance: spacings, travel for which gathered candidates stay valid. More: longer lists, gathered less often.
// kQuasiStaticTravel: of that distance: candidates are reused if a step moves by less. Larger: reuse at higher speeds.
constexpr double kReuseDistance = 0.03, kQuasiStaticTravel = 0.3;
// Of the margin: approach of open contacts while active ones are reused. Larger: longer reuse, longer search distance.
constexpr double kReuseMarginFraction = 0.5;
// Of the offset: a contact that slides farther in a step may be above another face at its end. Smaller: more searches.
constexpr double kFarSlide = 0.1;
// Of the offset: a path that passes the plane of a face so far beside it still crosses it. Larger: more crossings.
constexpr double kBesideFace = 0.5;
constexpr double kTiny = 1e-6;  // spacings: shorter connections have no direction

std::uint64_t keyOf(int kind, Index a, Index b) {
  return (static_cast<std::uint64_t>(kind) << 62) | (static_cast<std::uint64_t>(a) << 31) | b;
}

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

// Whether a direction points out of the wedge of faces around an edge.
bool leadsOut(MovingSkin &skin, Index edge, const Vec3 &direction, double tolerance) {
  const SkinEdge &e = skin.skin().edges[edge];
  const Vec3 a = skin.position(e.ends[0]), along = (skin.position(e.ends[1]) - a).normalized();
  for (const Index t : e.triangles) {
    if (t == kNoTriangle) continue;
    const auto &corners = skin.skin().triangles[t];
    const Index opposite = corners[0] + corners[1] + corners[2] - e.ends[0] - e.ends[1];
    Vec3 into = skin.position(opposite) - a;
    into -= along.dot(into) * along;
    if (direction.dot(into) > tolerance * into.norm()) return false;
  }
  return true;
}

// Whether a neighbour of a vertex on its own skin is so much closer to a face with this normal that it hides the
// vertex.
bool isBehind(MovingSkin &skin, Index vertex, const Vec3 &normal) {
  const Vec3 x = skin.position(vertex);
  for (const Index t : skin.skin().trianglesOf.row(vertex))
    for (const Index other : skin.skin().triangles[t]) {
      const Vec3 edge = skin.position(other) - x;
      if (-edge.dot(normal) > kBehind * edge.norm()) return true;
    }
  return false;
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

void SkinPair::updateVertexContact(VertexCandidates &group) {
  const std::span<const Near> near = std::span<const Near>(near_).subspan(group.begin, group.end - group.begin);
  const Index vertex = near.front().vertex;
  const std::size_t s = near.front().ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const ContactSkin &surface = other.skin();
  const Vec3 p = own.position(vertex);
  Index triangle = near.front().triangle;
  NearestOnTriangle best = other.nearestOn(triangle, p);
  for (const Near &one : near.subspan(1))
    if (const NearestOnTriangle found = other.nearestOn(one.triangle, p); found.squared < best.squared) {
      best = found;
      triangle = one.triangle;
    }
  const double size = std::sqrt(best.squared), room = settings_.offset + settings_.margin;
  std::uint8_t &isInside = sides_[s].isInside[vertex];
  Vec3 velocity = own.velocity(vertex);
  for (std::size_t k = 0; k < 3; ++k)
    velocity -= best.weights[static_cast<Eigen::Index>(k)] * other.velocity(surface.triangles[triangle][k]);
  const double within = room + dt_ * velocity.norm();
  group.wake = isInside == 0 ? size - room - travelSinceGather_ : -std::numeric_limits<double>::infinity();
  if (isInside == 0 && size > within) return;
  const Vec3 way = p - other.pointOn(triangle, best.weights);
  const Vec3 outward = other.outwardAt(triangle, best.feature);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0;
  double distance = sign * size;
  // A vertex that has not entered near the surface is not inside. For a skin with itself the nearest triangles are
  // excluded, and a crushed skin may be inverted.
  if (sign < 0.0 && size > kDeep * spacing_ && (isSelf() || isInside == 0)) return;
  isInside = sign < 0.0 ? 1 : 0;
  Vec3 normal = size > kTiny * spacing_ ? Vec3(sign / size * way) : Vec3(outward.normalized());
  const bool slidesFar = distance > 0.0 && dt_ * velocity.norm() > kFarSlide * settings_.offset;
  if (steps_ != Steps::small && (distance > room || slidesFar)) {
    const Crossing met = distance > room ? firstCrossing(near) : faceAtEnd(near);
    if (met.triangle == kNoTriangle && distance > room) return;
    if (met.triangle != kNoTriangle) {
      triangle = met.triangle;
      best.weights = met.weights;
      normal = met.normal;
      distance = met.away;
    }
  }
  if (isSelf() && !(own.facing(vertex).dot(normal) < kFacing)) return;

  // If the layer is restored at once, without time, friction must not strain it.
  const auto offsetAt = [&](Index t) {
    const auto &[a, b, c] = surface.triangles[t];
    return settings_.offset * std::min(refinedAt(s, vertex), refinedAt(1 - s, a, b, c));
  };
  const double offset = offsetAt(triangle);
  const bool frees =
      steps_ == Steps::withoutTime && distance >= 0.0 && before_ > 0.0 && resolvesInitialOverlap() && offset > distance;
  // Vertices that only touch, without overlap, get their full layer back whatever the pressure.
  if (Side &side = sides_[s]; isInside != 0 && !side.initialPenetration.empty())
    restoreInitialPenetration(side.initialPenetration[vertex], offset - distance);
  const auto addAt = [&](Index t, const Vec3 &weights, const Vec3 &n, double away, Index number) {
    SkinContact contact;
    const double ownOffset = offsetAt(t), thickness = ownOffset / settings_.offset * settings_.thickness;
    contact.gap = away - ownOffset + initialPenetration(s, vertex);
    if (number == 0 && own.skin().areas[vertex] > 0.0) {
      double modulus = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        modulus += weights[static_cast<Eigen::Index>(k)] * other.modulus(surface.triangles[t][k]);
      // Each skin contributes half of the layer.
      const double ofOwn = own.modulus(vertex) / own.spacingAt(vertex),
                   ofOther = modulus / other.spacingAt(surface.triangles[t][0]);
      contact.stiffness = 0.5 * settings_.stiffness * std::min(ofOwn, ofOther) * own.skin().areas[vertex];
      contact.thickness = thickness;
    } else {
      contact.gap += thickness;
    }
    contact.key = keyOf(s, vertex, number);
    contact.friction = frees ? 0.0 : settings_.friction;
    const double side = s == 1 ? -1.0 : 1.0;
    // Displacement of the first skin relative to the second, along a normal that points from the second to the first.
    contact.normal = side * n;
    contact.parts[0] = {vertex, s == 1, side};
    for (std::size_t k = 0; k < 3; ++k)
      contact.parts[k + 1] = {surface.triangles[t][k], s == 0, -side * weights[static_cast<Eigen::Index>(k)]};
    add(std::move(contact), isInside != 0 ? away : std::max(away, 0.0), initialPenetration(s, vertex));
  };
  addAt(triangle, best.weights, normal, distance, 0);
  if (!(distance > 0.0) || (steps_ != Steps::small && size > room)) return;
  // Further contacts: faces next to it at an angle.
  std::array<Vec3, 4> normals{normal};
  std::size_t count = 1;
  for (const Near &one : near) {
    if (count == normals.size()) break;
    // Only where the vertex is above the interior; outside of it the nearest feature belongs to a neighbour.
    if (one.triangle == triangle) continue;
    const NearestOnTriangle found = other.nearestOn(one.triangle, p);
    if (found.feature != 0 || !(found.squared > 0.0) || !(found.squared <= within * within)) continue;
    const Vec3 from = p - other.pointOn(one.triangle, found.weights), n = from.normalized();
    if (!(from.dot(other.faceNormal(one.triangle)) > 0.0)) continue;
    if (std::any_of(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Vec3 &known) { return known.dot(n) > kOneSide; }))
      continue;
    normals[count] = n;
    addAt(one.triangle, found.weights, n, std::sqrt(found.squared), static_cast<Index>(count));
    ++count;
  }
}

SkinPair::Crossing SkinPair::firstCrossing(std::span<const Near> near) const {
  const std::size_t s = near.front().ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const Vec3 p = own.position(near.front().vertex), stepTravel = dt_ * own.velocity(near.front().vertex);
  Crossing first;
  double soonest = std::numeric_limits<double>::infinity();
  for (const Near &one : near) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const NearestOnTriangle atStart = other.nearestOn(one.triangle, p);
    const std::array<Vec3, 3> ways{dt_ * other.velocity(a), dt_ * other.velocity(b), dt_ * other.velocity(c)};
    const double away = n.dot(p - other.position(a));
    Vec3 seen = stepTravel;
    for (std::size_t k = 0; k < 3; ++k) seen -= atStart.weights[static_cast<Eigen::Index>(k)] * ways[k];
    const double left = away + n.dot(seen);
    if (!(away > 0.0) || !(left < settings_.offset)) continue;
    // Time at which the vertex passes the plane of the face, as part of the step; 1: it ends before the plane.
    const double part = left < 0.0 ? away / (away - left) : 1.0;
    const NearestOnTriangle there =
        nearestOnTriangle(p + part * stepTravel, other.position(a) + part * ways[0], other.position(b) + part * ways[1],
                          other.position(c) + part * ways[2]);
    const double tolerance = std::max(kBesideFace * settings_.offset, left);
    if (!(there.squared <= tolerance * tolerance) || !(part < soonest)) continue;
    soonest = part;
    first = {one.triangle, there.weights, n, away};
  }
  // A floor vertex ahead of a block that sinks in before its contacts are found crosses the front of the block. The
  // face above which it ends is the one that separates the two.
  if (first.triangle != kNoTriangle && isBehind(own, near.front().vertex, first.normal))
    if (const Crossing over = faceAtEnd(near); over.triangle != kNoTriangle) return over;
  return first;
}

// A vertex outside of an edge at the beginning of a step may be above a face at its end.
SkinPair::Crossing SkinPair::faceAtEnd(std::span<const Near> near) const {
  const std::size_t s = near.front().ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const auto endOf = [&](MovingSkin &skin, Index v) { return Vec3(skin.position(v) + dt_ * skin.velocity(v)); };
  const Vec3 p = own.position(near.front().vertex), end = endOf(own, near.front().vertex);
  Crossing over;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Near &one : near) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const std::array<Vec3, 3> ends{endOf(other, a), endOf(other, b), endOf(other, c)};
    const NearestOnTriangle found = nearestOnTriangle(end, ends[0], ends[1], ends[2]);
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const double away = n.dot(p - other.position(a));
    // Ahead of a body, the plane of a slightly rotated face may be behind the vertex.
    if (!(found.squared < nearest) || !(away > -kCone * (p - other.position(a)).norm())) continue;
    // On the border of two faces the vertex is above both of them.
    const Vec3 off = end - found.weights[0] * ends[0] - found.weights[1] * ends[1] - found.weights[2] * ends[2];
    if (found.feature != 0 && !(tangential(off, n).norm() <= kCone * off.norm() + kTiny * spacing_)) continue;
    // Its own skin faces that face. Along a side that both bodies have in one plane it does not.
    if (isBehind(own, near.front().vertex, n) || !(own.vertexNormal(near.front().vertex).dot(n) < 0.0)) continue;
    nearest = found.squared;
    over = {one.triangle, found.weights, n, away};
  }
  return over;
}

void SkinPair::updateEdgeContact(EdgeCandidates &pair) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const auto &a = first.skin().edges[pair.first].ends, &b = second.skin().edges[pair.second].ends;
  const NearestOfSegments at =
      nearestOfSegments(first.position(a[0]), first.position(a[1]), second.position(b[0]), second.position(b[1]));
  const Vec3 p = (1.0 - at.onFirst) * first.position(a[0]) + at.onFirst * first.position(a[1]);
  const Vec3 q = (1.0 - at.onSecond) * second.position(b[0]) + at.onSecond * second.position(b[1]);
  const Vec3 way = p - q;
  const double size = way.norm();
  const double room = settings_.offset + settings_.margin;
  pair.wake = size - room - travelSinceGather_;
  if (size - room > stepTravel_) return;
  const Vec3 outward = second.edgeNormal(pair.second);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0;
  // Deep overlap is left to the vertices: two edges may pass each other behind the faces.
  if (sign < 0.0 && size > kDeep * spacing_) return;
  if (isSelf()) {
    const std::vector<Vec3> &rest = first.skin().vertices.positions;
    const auto between = [&](const std::array<Index, 2> &ends, double part) {
      return Vec3((1.0 - part) * rest[ends[0]] + part * rest[ends[1]]);
    };
    if (areOnePiece(between(a, at.onFirst), between(b, at.onSecond))) return;
  }
  const auto isWithin = [](double part) { return part > kEnds && part < 1.0 - kEnds; };
  if (!isWithin(at.onFirst) || !isWithin(at.onSecond)) return;
  const Vec3 normal = size > kTiny * spacing_ ? Vec3(sign / size * way) : Vec3(outward.normalized());
  const double refined = std::min(refinedAt(0, a[0], a[1]), refinedAt(1, b[0], b[1]));
  if (steps_ != Steps::small && sign * size > room) {
    // Do the edges pass each other within the step?
    const auto endOf = [&](MovingSkin &skin, Index v) { return Vec3(skin.position(v) + dt_ * skin.velocity(v)); };
    const Vec3 a0 = endOf(first, a[0]), a1 = endOf(first, a[1]), b0 = endOf(second, b[0]), b1 = endOf(second, b[1]);
    const NearestOfSegments then = nearestOfSegments(a0, a1, b0, b1);
    const Vec3 off = (1.0 - then.onFirst) * a0 + then.onFirst * a1 - (1.0 - then.onSecond) * b0 - then.onSecond * b1;
    if (!isWithin(then.onFirst) || !isWithin(then.onSecond) || !(off.dot(normal) < refined * settings_.offset)) return;
  }
  const double tolerance = sign > 0.0 ? kCone : 0.0;
  if (!leadsOut(second, pair.second, normal, tolerance) || !leadsOut(first, pair.first, -normal, tolerance)) return;
  SkinContact contact;
  contact.normal = normal;
  const double distance = sign * size;
  double allowed = 0.0;
  for (std::size_t k = 0; k < 2; ++k)
    allowed = std::max({allowed, initialPenetration(0, a[k]), initialPenetration(1, b[k])});
  contact.gap = distance - refined * (settings_.offset - settings_.thickness) + allowed;
  contact.key = keyOf(2, pair.first, pair.second);
  contact.friction = settings_.friction;
  contact.parts = {{{a[0], false, 1.0 - at.onFirst},
                    {a[1], false, at.onFirst},
                    {b[0], true, at.onSecond - 1.0},
                    {b[1], true, -at.onSecond}}};
  add(std::move(contact), distance, allowed);
}

void SkinPair::add(SkinContact contact, double distance, double allowed) {
  // Where a body is inverted its skin has no outside.
  if (isSelf() && std::any_of(contact.parts.begin(), contact.parts.end(), [&](const SkinContact::Part &part) {
        return part.weight != 0.0 && sides_[0].skin->isInverted(part.vertex);
      }))
    return;
  depth_ = std::max(depth_, -distance - (resolvesInitialOverlap() ? 0.0 : allowed));
  const double left = contact.gap - settings_.margin;
  Vec3 velocity = Vec3::Zero();
  for (const SkinContact::Part &part : contact.parts)
    velocity += part.weight * sides_[part.ofSecond ? 1 : 0].skin->velocity(part.vertex);
  const double closes = std::max(0.0, -dt_ * velocity.dot(contact.normal));
  if (left > closes + kSpeedMargin * dt_ * velocity.norm() && !isFirst_) return;
  if (!(contact.stiffness > 0.0))
    contact.gap = std::min(contact.gap, std::max(0.0, contact.gap - kSpeedMargin * dt_ * velocity.norm()));
  active_.push_back(std::move(contact));
}

// Overlap found by the first find() is tolerated, and pushed apart slowly.
void SkinPair::recordInitialPenetration() {
  for (SkinContact &contact : active_) {
    if (!(contact.gap < 0.0)) continue;
    for (const SkinContact::Part &part : contact.parts) {
      Side &side = sides_[part.ofSecond ? 1 : 0];
      if (side.initialPenetration.empty()) side.initialPenetration.assign(side.skin->skin().count(), 0.0);
      side.initialPenetration[part.vertex] = std::max(side.initialPenetration[part.vertex], -contact.gap);
      if (!contact.isOfEdges()) break;  // for vertex against face, the vertex stores it
    }
    allowed_ = std::max(allowed_, -contact.gap);
    contact.gap = 0.0;
  }
}

// Reduces all tolerated overlap; restoreInitialPenetration() restores it where a contact would press too much.
void SkinPair::relaxInitialPenetration() {
  if (!eases_ || !resolvesInitialOverlap() || !(allowed_ > 0.0)) return;
  wasEased_ = true;
  allowed_ = 0.0;
  for (Side &side : sides_)
    for (double &initialPenetration : side.initialPenetration) {
      initialPenetration = std::max(0.0, initialPenetration - settings_.ease * dt_);
      allowed_ = std::max(allowed_, initialPenetration);
    }
  if (!(allowed_ > 0.0))
    for (Side &side : sides_) side.initialPenetration.clear();
}

void SkinPair::restoreInitialPenetration(double &initialPenetration, double overlap) const {
  if (eases_ && initialPenetration > 0.0)
    initialPenetration =
        std::clamp(overlap - settings_.gentle, initialPenetration, initialPenetration + settings_.ease * dt_);
}

void SkinPair::setMemory(const Memory &memory) {
  active_ = memory.active;
  for (std::size_t s = 0; s < 2; ++s) {
    sides_[s].initialPenetration = memory.initialPenetrations[s];
    sides_[s].isInside = memory.isInside[s];
  }
  allowed_ = memory.allowed;
  isFirst_ = false;
  sinceList_.forget();
  if (forecast_) forecast_->forget();
  sum_ = Sum();
  sinceFound_.from = memory.foundAt;
  validTravel_ = memory.validTravel;
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

void SkinPair::updateActive() {
  invalidateSearch();  // gaps remain those of the beginning of the step
  for (SkinContact &contact : active_) {
    if (!(contact.normalImpulse > 0.0)) continue;
    const auto at = [&](std::size_t k) {
      const SkinContact::Part &part = contact.parts[k];
      return sides_[part.ofSecond ? 1 : 0].skin->position(part.vertex);
    };
    std::array<double, 4> weights{};
    if (contact.isOfEdges()) {
      const NearestOfSegments near = nearestOfSegments(at(0), at(1), at(2), at(3));
      weights = {1.0 - near.onFirst, near.onFirst, near.onSecond - 1.0, -near.onSecond};
    } else {
      const double side = contact.parts[0].weight;
      const NearestOnTriangle near = nearestOnTriangle(at(0), at(1), at(2), at(3));
      weights = {side, -side * near.weights[0], -side * near.weights[1], -side * near.weights[2]};
    }
    Vec3 way = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) way += weights[k] * at(k);
    const double size = way.norm();
    if (!(size > kTiny * spacing_)) continue;
    const Vec3 normal = (way.dot(contact.normal) >= 0.0 ? 1.0 : -1.0) / size * way;
    // The normal has turned to another side: left to the next step.
    if (normal.dot(contact.normal) < kSameSide) continue;
    for (std::size_t k = 0; k < 4; ++k) contact.parts[k].weight = weights[k];
    contact.normal = normal;
    contact.frictionImpulse = tangential(contact.frictionImpulse, normal);
    contact.settleFriction = tangential(contact.settleFriction, normal);
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
