// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "contact/contact_search.h"

namespace pointbased::detail {
namespace {

// Where steps go far, places are listed as far as so many of their ways, up to a spacing, and at least two.
constexpr double kWays = 12.0, kFarthest = 1.0, kFewestWays = 2.0;
// In spacings: deeper inside is only what was seen inside before.
constexpr double kDeep = 0.1;
// Edges whose faces meet at a smaller angle (its sine) are smooth: the vertices beside them tell all.
// An edge that is so long rises, times the offset, beyond its neighbours however smooth it is.
constexpr double kSharp = 0.05, kRise = 0.05;
// Of the way of a step: what moves fast against each other keeps so much more apart, so that what the solution leaves
// of its speed, and planes that are those of the beginning of the step, do not take it through.
constexpr double kCushion = 0.1;
// Of the cone of directions that lead out of an edge, and of its ends: rounding.
constexpr double kCone = 0.05, kEnds = 1e-6;
// Sides of which the normals are closer than this cosine are one.
constexpr double kOneSide = 0.7;
// Sine of the angle between a face and the edge to a neighbour of a vertex. A neighbour beyond it is so much nearer to
// the face that it reaches the plane of the face first.
constexpr double kBehind = 0.65;
// Skins of one body meet face to face.
constexpr double kFacing = -0.2;
// What is gathered serves until both have moved by that, in spacings, where a step goes by less than a part of it.
constexpr double kSlack = 0.03, kCalm = 0.3;
// Of the margin: contacts that do not press yet come no nearer while those that do are kept as they are.
constexpr double kServes = 0.5;
// Of the offset: what slides that far in a step may be over another face then.
constexpr double kFarSlide = 0.1;
// Of the offset: a way that comes through the plane of a face so far beside it meets it.
constexpr double kBesideFace = 0.5;
constexpr double kTiny = 1e-6;  // spacings: below it a connection has no direction

std::uint64_t keyOf(int kind, Index a, Index b) {
  return (static_cast<std::uint64_t>(kind) << 62) | (static_cast<std::uint64_t>(a) << 31) | b;
}

bool share(const std::array<Index, 2> &a, const std::array<Index, 2> &b) {
  return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
}

// m, at rest; 0: there are none.
double meanEdge(const ContactSkin &skin) {
  double sum = 0.0;
  for (const SkinEdge &edge : skin.edges)
    sum += (skin.vertices.positions[edge.ends[1]] - skin.vertices.positions[edge.ends[0]]).norm();
  return skin.edges.empty() ? 0.0 : sum / static_cast<double>(skin.edges.size());
}

// Whether a direction leads out of an edge between all that is around it.
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

// Whether the own skin of a vertex rises steeply beside it towards a face with this normal.
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

std::optional<bool> SkinPair::foretold() {
  return forecast_->serves() ? std::optional<bool>(forecast_->meets()) : std::nullopt;
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
  const double went = first.wentSince(from[0], ofFirst);
  return went + (pair.isSelf() ? went : second.wentSince(from[1], ofSecond) + (ofFirst - ofSecond).norm());
}

// From the vertices themselves, where the bounds by phyxels do not tell.
void SkinPair::measureExactly() {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  goes_ = first.goesExactly() + second.goesExactly() + (first.meanGoes() - second.meanGoes()).norm();
  if (sinceList_.from[0].empty()) return;
  std::array<Vec3, 2> means;
  went_ = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *sides_[s].skin;
    (void)skin.wentSince(sinceList_.from[s], means[s]);
    skin.placeVertices();
    double squared = 0.0;
    for (std::size_t v = 0; v < listedAt_[s].size(); ++v)
      squared = std::max(squared, (skin.positions()[v] - listedAt_[s][v] - means[s]).squaredNorm());
    went_ += std::sqrt(squared);
  }
  went_ += (means[0] - means[1]).norm();
}

// The same for what is gathered, since then.
void SkinPair::measureGathered(bool hasGathered) {
  std::array<Vec3, 2> means{Vec3::Zero(), Vec3::Zero()};
  double goes = 0.0, moved = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *sides_[s].skin;
    if (hasGathered) (void)skin.wentSince(sinceGathered_.from[s], means[s]);
    double farthest = 0.0, fastest = 0.0;
    for (std::size_t k = 0; k < gatheredOf_[s].size(); ++k) {
      const Index v = gatheredOf_[s][k];
      fastest = std::max(fastest, (dt_ * skin.velocity(v) - skin.meanGoes()).squaredNorm());
      if (hasGathered) farthest = std::max(farthest, (skin.position(v) - gatheredAt_[s][k] - means[s]).squaredNorm());
    }
    goes += std::sqrt(fastest);
    moved += std::sqrt(farthest);
  }
  goes_ = goes + (sides_[0].skin->meanGoes() - sides_[1].skin->meanGoes()).norm();
  if (hasGathered) moved_ = moved + (means[0] - means[1]).norm();
}

bool SkinPair::serves() const {
  if (!(servesFor_ > 0.0)) return false;
  const MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const double goes = first.goes() + second.goes() + (first.meanGoes() - second.meanGoes()).norm();
  return sinceFound_.since(*this) + goes <= servesFor_;
}

// From here on, with what is left of its reach.
void SkinPair::keepList() {
  listReach_ -= went_;
  for (NearPatches &pair : listed_) pair.apart -= went_;
  went_ = 0.0;
  sinceList_.begin(*this);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::span<const Vec3> x = sides_[s].skin->positions();
    listedAt_[s].assign(x.begin(), x.end());
  }
}

// @return whether what has been gathered is of the same list
bool SkinPair::renewList() {
  const bool isNew = sinceList_.from[0].empty();
  if (!isNew) went_ = sinceList_.since(*this);
  const double room = settings_.offset + settings_.margin;
  const double serves = kServes * settings_.margin;
  const auto isOld = [&] { return isNew || !(went_ + goes_ + serves <= listReach_ - room); };
  if (!isOld()) return true;
  measureExactly();
  const bool lists = isOld();
  if (lists) {
    listReach_ = room + serves +
                 std::max({settings_.leastReach, std::min(kWays * goes_, kFarthest * spacing_), kFewestWays * goes_});
    went_ = 0.0;
    list(listReach_);
  }
  keepList();
  return !lists;
}

bool SkinPair::renewForecast() {
  if (!forecast_->serves()) forecast_->look();
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
  goes_ = first.goes() + second.goes() + (first.meanGoes() - second.meanGoes()).norm();
  const bool hasGathered = isSelf() ? renewForecast() : renewList();
  const double serves = kServes * settings_.margin;
  std::swap(previous_, active_);
  active_.clear();
  depth_ = 0.0;
  moved_ = hasGathered && slack_ > 0.0 && !listed_.empty() ? sinceGathered_.since(*this) : 0.0;
  const auto isCalm = [this] { return goes_ <= kCalm * kSlack * spacing_; };
  if (!isSelf() && !listed_.empty() && (!isCalm() || moved_ + goes_ > slack_))
    measureGathered(hasGathered && slack_ > 0.0);
  if (!hasGathered || !(slack_ > 0.0 && moved_ + goes_ <= slack_)) {
    moved_ = 0.0;
    slack_ = isCalm() ? kSlack * spacing_ : 0.0;
    gatherNear();
    if (slack_ > 0.0) {
      sinceGathered_.begin(*this);
      for (std::size_t s = 0; s < 2; ++s) {
        gatheredAt_[s].clear();
        for (const Index v : gatheredOf_[s]) gatheredAt_[s].push_back(sides_[s].skin->position(v));
      }
    }
  }
  easeAllowances();
  for (NearVertex &group : vertices_)
    if (!(group.wake > moved_ + goes_)) lookAt(group);
  for (NearEdges &pair : edges_)
    if (!(pair.wake > moved_ + goes_)) lookAt(pair);
  servesFor_ = isFirst_ || (allowed_ > 0.0 && leadsApart()) || steps_ != Steps::small ? 0.0 : serves;
  if (servesFor_ > 0.0) sinceFound_.begin(*this);
  if (isFirst_) learnAllowances();
  if (isFirst_ && !leadsApart()) depth_ = 0.0;
  isFirst_ = false;
  // Where nothing is near and nothing inside, nothing overlaps any more.
  const auto hasInside = [](const Side &side) {
    return std::find(side.isInside.begin(), side.isInside.end(), 1) != side.isInside.end();
  };
  if (allowed_ > 0.0 && listed_.empty() && std::none_of(sides_.begin(), sides_.end(), hasInside)) {
    for (Side &side : sides_) side.allowance.clear();
    allowed_ = 0.0;
  }
  keepMemories();
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

// What lies inside the other when both are looked at for the first time; later it is known how it came there.
void SkinPair::findInside(std::size_t side) {
  MovingSkin &own = *sides_[side].skin, &other = *sides_[1 - side].skin;
  // Skins of what fits cross by less than their edges are long; what seems deeper lies beside a rim.
  const double deepest = leadsApart() ? std::numeric_limits<double>::infinity()
                                      : std::max({kDeep * spacing_, meanEdge(own.skin()), meanEdge(other.skin())});
  for (Index v = 0; v < own.skin().count(); ++v) {
    const Vec3 &x = own.positions()[v];
    if (!(own.skin().areas[v] > 0.0) || other.tree().bounds().squaredDistance(x) > 0.0) continue;
    const Index t = other.nearestTriangle(x);
    const NearestOnTriangle found = other.nearestOn(t, x);
    if (found.squared > deepest * deepest) continue;
    if ((x - other.placeOn(t, found.weights)).dot(other.outwardAt(t, found.feature)) < 0.0)
      sides_[side].isInside[v] = 1;
  }
}

// Vertices and triangles, edges and edges that may touch within the step.
void SkinPair::gatherNear() {
  near_.clear();
  edges_.clear();
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const double room = settings_.offset + settings_.margin;
  for (std::size_t k = 0; k < listed_.size(); ++k) {
    auto &[a, b, apart] = listed_[k];
    if (isSelf() ? !forecast_->mayMeet(forecast_->pairs()[k]) : apart - went_ > room + slack_ + goes_) continue;
    const MovingSkin::PatchMotion &mine = first.motionOf(a), &theirs = second.motionOf(b);
    // The fastest that a point of one can go, seen from one of the other.
    const Vec3 fastest = (mine.velocities.high - theirs.velocities.low)
                             .cwiseAbs()
                             .cwiseMax((theirs.velocities.high - mine.velocities.low).cwiseAbs());
    const double reach = room + slack_ + (1.0 + kCushion) * dt_ * fastest.norm();
    double distance = std::sqrt(mine.places.squaredDistance(theirs.places));
    if (distance <= reach)
      distance = std::max({distance, first.distance(a, second.slabOf(b)), second.distance(b, first.slabOf(a))});
    apart = distance - went_;
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
    for (const bool ofSecond : {false, true}) addDeep(ofSecond);
    if (near_.size() > had) std::sort(near_.begin(), near_.end(), before);
  }
  constexpr double kNow = -std::numeric_limits<double>::infinity();
  vertices_.clear();
  for (std::size_t begin = 0, end = 0; begin < near_.size(); begin = end) {
    while (end < near_.size() && near_[end].isOf(near_[begin])) ++end;
    vertices_.push_back({begin, end, kNow});
  }
  std::sort(edges_.begin(), edges_.end(), [](const NearEdges &a, const NearEdges &b) {
    return std::tuple(a.first, a.second) < std::tuple(b.first, b.second);
  });
}

// Vertices deep inside have nothing within reach.
void SkinPair::addDeep(bool ofSecond) {
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

void SkinPair::lookAt(NearVertex &group) {
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
  group.wake = isInside == 0 ? size - room - moved_ : -std::numeric_limits<double>::infinity();
  if (isInside == 0 && size > within) return;
  const Vec3 way = p - other.placeOn(triangle, best.weights);
  const Vec3 outward = other.outwardAt(triangle, best.feature);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0;
  double distance = sign * size;
  // What has not come in near the surface is not inside: of one skin the nearest places are left out, and where a skin
  // has been crushed it may be turned over.
  if (sign < 0.0 && size > kDeep * spacing_ && (isSelf() || isInside == 0)) return;
  isInside = sign < 0.0 ? 1 : 0;
  Vec3 normal = size > kTiny * spacing_ ? Vec3(sign / size * way) : Vec3(outward.normalized());
  const bool slidesFar = distance > 0.0 && dt_ * velocity.norm() > kFarSlide * settings_.offset;
  if (steps_ != Steps::small && (distance > room || slidesFar)) {
    const Met met = distance > room ? followWay(near) : overAtEnd(near);
    if (met.triangle == kNoTriangle && distance > room) return;
    if (met.triangle != kNoTriangle) {
      triangle = met.triangle;
      best.weights = met.weights;
      normal = met.normal;
      distance = met.away;
    }
  }
  if (isSelf() && !(own.facing(vertex).dot(normal) < kFacing)) return;

  // A layer that is given back at once, without time, is not to be strained by friction.
  const auto offsetAt = [&](Index t) {
    const auto &[a, b, c] = surface.triangles[t];
    return settings_.offset * std::min(refinedAt(s, vertex), refinedAt(1 - s, a, b, c));
  };
  const double offset = offsetAt(triangle);
  const bool frees =
      steps_ == Steps::withoutTime && distance >= 0.0 && before_ > 0.0 && leadsApart() && offset > distance;
  // What only touches, without an overlap, gets all of its layer back whatever presses on it.
  if (Side &side = sides_[s]; isInside != 0 && !side.allowance.empty())
    holdBack(side.allowance[vertex], offset - distance);
  const auto addAt = [&](Index t, const Vec3 &weights, const Vec3 &n, double away, Index number) {
    SkinContact contact;
    const double ownOffset = offsetAt(t), thickness = ownOffset / settings_.offset * settings_.thickness;
    contact.gap = away - ownOffset + allowance(s, vertex);
    if (number == 0 && own.skin().areas[vertex] > 0.0) {
      double modulus = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        modulus += weights[static_cast<Eigen::Index>(k)] * other.modulus(surface.triangles[t][k]);
      // Either skin carries half.
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
    // The way of the first seen from the second, along a normal that leads from the second to the first.
    contact.normal = side * n;
    contact.parts[0] = {vertex, s == 1, side};
    for (std::size_t k = 0; k < 3; ++k)
      contact.parts[k + 1] = {surface.triangles[t][k], s == 0, -side * weights[static_cast<Eigen::Index>(k)]};
    add(std::move(contact), isInside != 0 ? away : std::max(away, 0.0), allowance(s, vertex));
  };
  addAt(triangle, best.weights, normal, distance, 0);
  if (!(distance > 0.0) || (steps_ != Steps::small && size > room)) return;
  // What stands beside it at an angle.
  std::array<Vec3, 4> normals{normal};
  std::size_t count = 1;
  for (const Near &one : near) {
    if (count == normals.size()) break;
    // Over its inside; beyond its edges it is nearest to what is beside it.
    if (one.triangle == triangle) continue;
    const NearestOnTriangle found = other.nearestOn(one.triangle, p);
    if (found.feature != 0 || !(found.squared > 0.0) || !(found.squared <= within * within)) continue;
    const Vec3 from = p - other.placeOn(one.triangle, found.weights), n = from.normalized();
    if (!(from.dot(other.faceNormal(one.triangle)) > 0.0)) continue;
    if (std::any_of(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Vec3 &known) { return known.dot(n) > kOneSide; }))
      continue;
    normals[count] = n;
    addAt(one.triangle, found.weights, n, std::sqrt(found.squared), static_cast<Index>(count));
    ++count;
  }
}

SkinPair::Met SkinPair::followWay(std::span<const Near> near) const {
  const std::size_t s = near.front().ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const Vec3 p = own.position(near.front().vertex), goes = dt_ * own.velocity(near.front().vertex);
  Met first;
  double soonest = std::numeric_limits<double>::infinity();
  for (const Near &one : near) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const NearestOnTriangle atStart = other.nearestOn(one.triangle, p);
    const std::array<Vec3, 3> ways{dt_ * other.velocity(a), dt_ * other.velocity(b), dt_ * other.velocity(c)};
    const double away = n.dot(p - other.position(a));
    Vec3 seen = goes;
    for (std::size_t k = 0; k < 3; ++k) seen -= atStart.weights[static_cast<Eigen::Index>(k)] * ways[k];
    const double left = away + n.dot(seen);
    if (!(away > 0.0) || !(left < settings_.offset)) continue;
    // Where it comes through the plane of the face, or ends before it.
    const double part = left < 0.0 ? away / (away - left) : 1.0;
    const NearestOnTriangle there =
        nearestOnTriangle(p + part * goes, other.position(a) + part * ways[0], other.position(b) + part * ways[1],
                          other.position(c) + part * ways[2]);
    const double tolerance = std::max(kBesideFace * settings_.offset, left);
    if (!(there.squared <= tolerance * tolerance) || !(part < soonest)) continue;
    soonest = part;
    first = {one.triangle, there.weights, n, away};
  }
  // A vertex of a floor ahead of a block that sinks in, before its contacts are known, meets the front of the block.
  // What holds the two apart is the face that it is over at the end.
  if (first.triangle != kNoTriangle && isBehind(own, near.front().vertex, first.normal))
    if (const Met over = overAtEnd(near); over.triangle != kNoTriangle) return over;
  return first;
}

// What is beside an edge at the beginning may be over a face at the end.
SkinPair::Met SkinPair::overAtEnd(std::span<const Near> near) const {
  const std::size_t s = near.front().ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const auto endOf = [&](MovingSkin &skin, Index v) { return Vec3(skin.position(v) + dt_ * skin.velocity(v)); };
  const Vec3 p = own.position(near.front().vertex), end = endOf(own, near.front().vertex);
  Met over;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Near &one : near) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const std::array<Vec3, 3> ends{endOf(other, a), endOf(other, b), endOf(other, c)};
    const NearestOnTriangle found = nearestOnTriangle(end, ends[0], ends[1], ends[2]);
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const double away = n.dot(p - other.position(a));
    // Ahead of a body the plane of a face that is slightly turned may lie behind the vertex.
    if (!(found.squared < nearest) || !(away > -kCone * (p - other.position(a)).norm())) continue;
    // Over the border of two faces it is over both of them.
    const Vec3 off = end - found.weights[0] * ends[0] - found.weights[1] * ends[1] - found.weights[2] * ends[2];
    if (found.feature != 0 && !(tangential(off, n).norm() <= kCone * off.norm() + kTiny * spacing_)) continue;
    // Its own skin faces that face. Along a side that both bodies have in one plane it does not.
    if (isBehind(own, near.front().vertex, n) || !(own.vertexNormal(near.front().vertex).dot(n) < 0.0)) continue;
    nearest = found.squared;
    over = {one.triangle, found.weights, n, away};
  }
  return over;
}

void SkinPair::lookAt(NearEdges &pair) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const auto &a = first.skin().edges[pair.first].ends, &b = second.skin().edges[pair.second].ends;
  const NearestOfSegments at =
      nearestOfSegments(first.position(a[0]), first.position(a[1]), second.position(b[0]), second.position(b[1]));
  const Vec3 p = (1.0 - at.onFirst) * first.position(a[0]) + at.onFirst * first.position(a[1]);
  const Vec3 q = (1.0 - at.onSecond) * second.position(b[0]) + at.onSecond * second.position(b[1]);
  const Vec3 way = p - q;
  const double size = way.norm();
  const double room = settings_.offset + settings_.margin;
  pair.wake = size - room - moved_;
  if (size - room > goes_) return;
  const Vec3 outward = second.edgeNormal(pair.second);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0;
  // What overlaps far is a matter of vertices: two edges may pass each other behind the faces.
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
    // Whether they pass each other on their way.
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
  for (std::size_t k = 0; k < 2; ++k) allowed = std::max({allowed, allowance(0, a[k]), allowance(1, b[k])});
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
  // Where a body is turned inside out its skin has no outside.
  if (isSelf() && std::any_of(contact.parts.begin(), contact.parts.end(), [&](const SkinContact::Part &part) {
        return part.weight != 0.0 && sides_[0].skin->isInverted(part.vertex);
      }))
    return;
  depth_ = std::max(depth_, -distance - (leadsApart() ? 0.0 : allowed));
  const double left = contact.gap - settings_.margin;
  Vec3 velocity = Vec3::Zero();
  for (const SkinContact::Part &part : contact.parts)
    velocity += part.weight * sides_[part.ofSecond ? 1 : 0].skin->velocity(part.vertex);
  const double closes = std::max(0.0, -dt_ * velocity.dot(contact.normal));
  if (left > closes + kCushion * dt_ * velocity.norm() && !isFirst_) return;
  if (!(contact.stiffness > 0.0))
    contact.gap = std::min(contact.gap, std::max(0.0, contact.gap - kCushion * dt_ * velocity.norm()));
  active_.push_back(std::move(contact));
}

// What overlaps when the two are looked at for the first time stays so, and is led apart slowly.
void SkinPair::learnAllowances() {
  for (SkinContact &contact : active_) {
    if (!(contact.gap < 0.0)) continue;
    for (const SkinContact::Part &part : contact.parts) {
      Side &side = sides_[part.ofSecond ? 1 : 0];
      if (side.allowance.empty()) side.allowance.assign(side.skin->skin().count(), 0.0);
      side.allowance[part.vertex] = std::max(side.allowance[part.vertex], -contact.gap);
      if (!contact.isOfEdges()) break;  // of a vertex and a face the vertex knows it
    }
    allowed_ = std::max(allowed_, -contact.gap);
    contact.gap = 0.0;
  }
}

// All of them; what presses more than gently takes it back (holdBack()).
void SkinPair::easeAllowances() {
  if (!eases_ || !leadsApart() || !(allowed_ > 0.0)) return;
  wasEased_ = true;
  allowed_ = 0.0;
  for (Side &side : sides_)
    for (double &allowance : side.allowance) {
      allowance = std::max(0.0, allowance - settings_.ease * dt_);
      allowed_ = std::max(allowed_, allowance);
    }
  if (!(allowed_ > 0.0))
    for (Side &side : sides_) side.allowance.clear();
}

void SkinPair::holdBack(double &allowance, double overlap) const {
  if (eases_ && allowance > 0.0)
    allowance = std::clamp(overlap - settings_.gentle, allowance, allowance + settings_.ease * dt_);
}

void SkinPair::setMemory(const Memory &memory) {
  active_ = memory.active;
  for (std::size_t s = 0; s < 2; ++s) {
    sides_[s].allowance = memory.allowances[s];
    sides_[s].isInside = memory.isInside[s];
  }
  allowed_ = memory.allowed;
  isFirst_ = false;
  sinceList_.forget();
  if (forecast_) forecast_->forget();
  sum_ = Sum();
  sinceFound_.from = memory.foundAt;
  servesFor_ = memory.servesFor;
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

void SkinPair::renewPressing() {
  findAnew();  // gaps stay those of the beginning of the step
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
    // Another side by now: the next step finds it.
    if (normal.dot(contact.normal) < kSameSide) continue;
    for (std::size_t k = 0; k < 4; ++k) contact.parts[k].weight = weights[k];
    contact.normal = normal;
    contact.frictionImpulse = tangential(contact.frictionImpulse, normal);
    contact.settleFriction = tangential(contact.settleFriction, normal);
  }
}

void SkinPair::keepMemories() {
  std::size_t from = 0;
  for (SkinContact &contact : active_) {
    while (from < previous_.size() && previous_[from].key < contact.key) ++from;
    if (from < previous_.size() && previous_[from].key == contact.key) remember(previous_[from], contact);
  }
}

}  // namespace pointbased::detail
