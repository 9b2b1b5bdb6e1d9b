// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/contact_search.h"

namespace pointbased::detail {
namespace {

// Where steps go far, places are listed as far as so many of their ways, up to a spacing, and at least two.
constexpr double kWays = 12.0, kFarthest = 1.0, kFewestWays = 2.0;
// What overlaps more than that, in spacings, is looked for beyond the list.
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
// Skins of one body meet face to face.
constexpr double kFacing = -0.2;
constexpr double kTiny = 1e-6;  // spacings: below it a connection has no direction

std::uint64_t keyOf(int kind, Index a, Index b) {
  return (static_cast<std::uint64_t>(kind) << 62) | (static_cast<std::uint64_t>(a) << 31) | b;
}

bool share(const std::array<Index, 2> &a, const std::array<Index, 2> &b) {
  return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
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

bool isSharp(MovingSkin &skin, Index edge, double offset) {
  const SkinEdge &e = skin.skin().edges[edge];
  if (e.triangles[1] == kNoTriangle) return true;
  const Vec3 n = skin.faceNormal(e.triangles[0]), m = skin.faceNormal(e.triangles[1]);
  const auto &corners = skin.skin().triangles[e.triangles[1]];
  const Index opposite = corners[0] + corners[1] + corners[2] - e.ends[0] - e.ends[1];
  const double length = (skin.position(e.ends[0]) - skin.position(e.ends[1])).norm();
  const double least = std::min(kSharp, kRise * offset / std::max(length, 1e-12 * offset));
  const bool convex = n.dot(skin.position(opposite) - skin.position(e.ends[0])) <= 0.0;
  return convex && (n.cross(m).squaredNorm() > least * least * n.squaredNorm() * m.squaredNorm() || n.dot(m) < 0.0);
}

}  // namespace

SkinPair::SkinPair(MovingSkin &first, MovingSkin &second, const SkinPairSettings &settings)
    : sides_{Side{&first, {}, {}}, Side{&second, {}, {}}}, settings_(settings),
      spacing_(std::min(first.spacing(), second.spacing())), seenBy_(second.skin().edges.size(), 0),
      sharpOf_(seenBy_.size(), 0), isSharpEdge_(seenBy_.size(), 0) {
  for (Side &side : sides_) {
    side.isInside.assign(side.skin->skin().count(), 0);
    const std::vector<Vec3> &rest = side.skin->skin().vertices.positions;
    for (const SkinEdge &edge : side.skin->skin().edges)
      longestEdge_ = std::max(longestEdge_, (rest[edge.ends[0]] - rest[edge.ends[1]]).norm());
  }
}

void SkinPair::measureWays() {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  goes_ = first.goes() + second.goes() + (first.meanGoes() - second.meanGoes()).norm();
  if (listed_[0].empty()) return;
  Vec3 ofFirst, ofSecond;
  went_ = first.wentSince(listed_[0], ofFirst);
  went_ += isSelf() ? went_ : second.wentSince(listed_[1], ofSecond) + (ofFirst - ofSecond).norm();
}

// The same from the vertices themselves, where the bounds by phyxels do not tell.
void SkinPair::measureExactly() {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  goes_ = first.goesExactly() + second.goesExactly() + (first.meanGoes() - second.meanGoes()).norm();
  if (listed_[0].empty()) return;
  std::array<Vec3, 2> means;
  went_ = 0.0;
  for (std::size_t s = 0; s < 2; ++s) {
    MovingSkin &skin = *sides_[s].skin;
    (void)skin.wentSince(listed_[s], means[s]);
    skin.placeVertices();
    double squared = 0.0;
    for (std::size_t v = 0; v < listedAt_[s].size(); ++v)
      squared = std::max(squared, (skin.positions()[v] - listedAt_[s][v] - means[s]).squaredNorm());
    went_ += std::sqrt(squared);
    if (!isSelf()) continue;
    went_ *= 2.0;
    return;
  }
  went_ += (means[0] - means[1]).norm();
}

void SkinPair::find(double dt) {
  dt_ = dt;
  measureWays();
  const double room = settings_.offset + settings_.margin;
  const auto isOld = [&] { return listed_[0].empty() || !(went_ + goes_ <= listReach_ - room); };
  if (isOld()) measureExactly();
  if (isOld()) {
    listReach_ = room + std::max({settings_.leastReach,
                                  std::min(kWays * goes_, isSelf() ? settings_.leastReach : kFarthest * spacing_),
                                  kFewestWays * goes_});
    for (std::size_t s = 0; s < 2; ++s) {
      const std::span<const Vec3> u = sides_[s].skin->displacements();
      listed_[s].assign(u.begin(), u.end());
      if (isSelf()) break;
    }
    went_ = 0.0;
    list(listReach_);
    for (std::size_t s = 0; s < 2; ++s) {
      const std::span<const Vec3> x = sides_[s].skin->positions();
      listedAt_[s].assign(x.begin(), x.end());
      if (isSelf()) break;
    }
  }
  reach_ = listReach_ - went_;
  std::swap(previous_, active_);
  active_.clear();
  depth_ = 0.0;
  for (VertexGroup &group : groups_)
    if (!(group.wake > went_ + goes_)) lookAt(group);
  for (EdgePair &pair : edges_)
    if (!(pair.wake > went_ + goes_)) lookAt(pair);
  if (isFirst_) learnAllowances();
  isFirst_ = false;
  measureAllowances();
  keepMemories();
}

void SkinPair::list(double reach) {
  sides_[0].skin->placeAll();
  if (!isSelf()) sides_[1].skin->placeAll();
  groups_.clear();
  near_.clear();
  edges_.clear();
  if (!sides_[0].skin->tree().bounds().wider(reach).meets(sides_[1].skin->tree().bounds())) return;
  // Of an edge that comes within reach one end is within reach and half its length, which may have grown by half.
  const double withEdges = reach + atEdges();
  for (std::size_t s = 0; s < 2; ++s) isNear_[s].assign(sides_[s].skin->skin().count(), 0);
  listVertices(false, withEdges);
  if (!isSelf()) listVertices(true, withEdges);
  if (!groups_.empty()) listEdges(reach);
}

bool SkinPair::areOnePiece(const Vec3 &a, const Vec3 &b) const {
  return isSelf() && (a - b).squaredNorm() <= settings_.apart * settings_.apart;
}

void SkinPair::listVertices(bool ofSecond, double reach) {
  MovingSkin &own = *sides_[ofSecond ? 1 : 0].skin, &other = *sides_[ofSecond ? 0 : 1].skin;
  const std::span<const Vec3> x = own.positions(), y = other.positions();
  const ContactSkin &surface = other.skin();
  const TriangleTree::Box within = other.tree().bounds().wider(reach);
  const std::vector<std::uint8_t> &isInside = sides_[ofSecond ? 1 : 0].isInside;
  const std::vector<Vec3> &rest = own.skin().vertices.positions;
  for (Index v = 0; v < x.size(); ++v) {
    if (!(own.skin().areas[v] > 0.0) || !within.meets({x[v], x[v]})) continue;
    const auto begin = static_cast<Index>(near_.size());
    const TriangleTree::Box around = TriangleTree::Box{x[v], x[v]}.wider(reach);
    double nearest = std::numeric_limits<double>::infinity();
    const auto isOnePiece = [&](const TriangleTree::Box &restBox) {
      return isSelf() && restBox.squaredFarthest(rest[v]) <= settings_.apart * settings_.apart;
    };
    other.tree().inBox(around, isOnePiece, [&](Index t) {
      const auto &[a, b, c] = surface.triangles[t];
      if (isSelf() && (a == v || b == v || c == v)) return;
      const NearestOnTriangle found = nearestOnTriangle(x[v], y[a], y[b], y[c]);
      if (!(found.squared <= reach * reach)) return;
      if (isSelf() &&
          areOnePiece(rest[v], found.weights[0] * rest[a] + found.weights[1] * rest[b] + found.weights[2] * rest[c]))
        return;
      nearest = std::min(nearest, found.squared);
      near_.push_back(t);
    });
    double complete = reach;
    const bool maybeDeep = !isSelf() && (isFirst_ || isInside[v] != 0);
    if (maybeDeep && near_.size() == begin) {
      // Maybe deep inside.
      Index at = kNoTriangle;
      double best = std::numeric_limits<double>::infinity();
      const auto nearestOn = [&](Index t) {
        const auto &[a, b, c] = surface.triangles[t];
        return nearestOnTriangle(x[v], y[a], y[b], y[c]);
      };
      other.tree().nearest(x[v], best, [&](Index t) {
        const double squared = nearestOn(t).squared;
        if (squared < best || (squared == best && t < at)) {
          best = squared;
          at = t;
        }
        return best;
      });
      if (at == kNoTriangle) continue;
      const auto &[a, b, c] = surface.triangles[at];
      const NearestOnTriangle found = nearestOn(at);
      const Vec3 way = x[v] - (found.weights[0] * y[a] + found.weights[1] * y[b] + found.weights[2] * y[c]);
      if (!(way.dot(other.outwardAt(at, found.feature)) < 0.0)) continue;
      complete += std::sqrt(best);
      other.tree().inBox(TriangleTree::Box{x[v], x[v]}.wider(complete), isOnePiece, [&](Index t) {
        if (nearestOn(t).squared <= complete * complete) near_.push_back(t);
      });
      nearest = 0.0;
    }
    const auto end = static_cast<Index>(near_.size());
    if (end == begin) continue;
    std::sort(near_.begin() + begin, near_.end());
    isNear_[ofSecond ? 1 : 0][v] = 1;
    // Which side it is on nobody knows yet.
    const double away = std::sqrt(nearest);
    const double wake = maybeDeep || away <= kDeep * spacing_ ? -std::numeric_limits<double>::infinity()
                                                              : away - settings_.offset - settings_.margin;
    groups_.push_back({v, ofSecond, begin, end, complete, wake});
  }
}

void SkinPair::listEdges(double reach) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const ContactSkin &own = first.skin(), &other = second.skin();
  const std::span<const Vec3> x = first.positions(), y = second.positions();
  const TriangleTree::Box within = second.tree().bounds().wider(reach);
  const std::vector<Vec3> &rest = own.vertices.positions;
  std::vector<Index> &found = found_;
  const std::vector<std::uint8_t> &nearOfSecond = isNear_[isSelf() ? 0 : 1];
  const auto isSharpOfSecond = [&](Index f) {
    if (sharpOf_[f] != list_) {
      sharpOf_[f] = list_;
      isSharpEdge_[f] = isSharp(second, f, settings_.offset) ? 1 : 0;
    }
    return isSharpEdge_[f] != 0;
  };
  ++list_;
  for (Index e = 0; e < own.edges.size(); ++e) {
    const auto &ends = own.edges[e].ends;
    if (isNear_[0][ends[0]] == 0 && isNear_[0][ends[1]] == 0) continue;
    TriangleTree::Box box;
    box.add(x[ends[0]]);
    box.add(x[ends[1]]);
    box = box.wider(reach);
    if (!within.meets(box) || !isSharp(first, e, settings_.offset)) continue;
    ++query_;
    found.clear();
    const auto isOnePiece = [&](const TriangleTree::Box &restBox) {
      return isSelf() && restBox.squaredFarthest(rest[ends[0]]) <= settings_.apart * settings_.apart &&
             restBox.squaredFarthest(rest[ends[1]]) <= settings_.apart * settings_.apart;
    };
    second.tree().inBox(box, isOnePiece, [&](Index t) {
      for (const Index f : other.edgesOf[t]) {
        if (seenBy_[f] == query_) continue;
        seenBy_[f] = query_;
        if (nearOfSecond[other.edges[f].ends[0]] == 0 && nearOfSecond[other.edges[f].ends[1]] == 0) continue;
        if (isSelf() && (f <= e || share(ends, other.edges[f].ends))) continue;
        const Vec3 &a = y[other.edges[f].ends[0]], &b = y[other.edges[f].ends[1]];
        if ((a.cwiseMin(b).array() > box.high.array()).any() || (a.cwiseMax(b).array() < box.low.array()).any())
          continue;
        if (isSharpOfSecond(f)) found.push_back(f);
      }
    });
    std::sort(found.begin(), found.end());
    for (const Index f : found) {
      const auto &those = other.edges[f].ends;
      const NearestOfSegments at = nearestOfSegments(x[ends[0]], x[ends[1]], y[those[0]], y[those[1]]);
      const auto between = [&](const auto &points, const std::array<Index, 2> &pair, double part) {
        return Vec3((1.0 - part) * points[pair[0]] + part * points[pair[1]]);
      };
      const double distance = (between(x, ends, at.onFirst) - between(y, those, at.onSecond)).norm();
      if (!(distance <= reach)) continue;
      if (isSelf() && areOnePiece(between(rest, ends, at.onFirst), between(rest, those, at.onSecond))) continue;
      edges_.push_back({e, f,
                        distance <= kDeep * spacing_ ? -std::numeric_limits<double>::infinity()
                                                     : distance - settings_.offset - settings_.margin});
    }
  }
}

void SkinPair::lookAt(VertexGroup &group) {
  const std::size_t s = group.ofSecond ? 1 : 0;
  MovingSkin &own = *sides_[s].skin, &other = *sides_[1 - s].skin;
  const ContactSkin &surface = other.skin();
  const Vec3 p = own.position(group.vertex);
  const auto nearestOn = [&](Index t) {
    const auto &[a, b, c] = surface.triangles[t];
    return nearestOnTriangle(p, other.position(a), other.position(b), other.position(c));
  };
  const auto placeOn = [&](Index t, const Vec3 &weights) {
    const auto &[a, b, c] = surface.triangles[t];
    return Vec3(weights[0] * other.position(a) + weights[1] * other.position(b) + weights[2] * other.position(c));
  };
  Index at = near_[group.begin];
  NearestOnTriangle best = nearestOn(at);
  for (Index k = group.begin + 1; k < group.end; ++k)
    if (const NearestOnTriangle found = nearestOn(near_[k]); found.squared < best.squared) {
      best = found;
      at = near_[k];
    }
  const double size = std::sqrt(best.squared);
  const double room = settings_.offset + settings_.margin;
  // Both ways are seen from the list.
  const double complete = group.reach - went_;
  group.wake = std::min(size, complete) - room - went_;
  // What is not listed may be nearer, and lead the other way.
  if (size > complete) return;
  const Vec3 way = p - placeOn(at, best.weights);
  const Vec3 outward = other.outwardAt(at, best.feature);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0, distance = sign * size;
  // What has not come in near the surface is not inside: of one skin the nearest places are left out, and where a skin
  // has been crushed it may be turned over.
  std::uint8_t &isInside = sides_[s].isInside[group.vertex];
  if (sign < 0.0 && size > kDeep * spacing_ && (isSelf() || (!isFirst_ && isInside == 0))) return;
  isInside = sign < 0.0 ? 1 : 0;
  if (sign < 0.0) group.wake = -std::numeric_limits<double>::infinity();
  if (group.wake > went_ + goes_) return;
  const Vec3 normal = size > kTiny * spacing_ ? Vec3(sign / size * way) : Vec3(outward.normalized());
  if (isSelf() && !(own.vertexNormal(group.vertex).normalized().dot(normal) < kFacing)) return;

  if (Side &side = sides_[s]; !side.allowance.empty()) ease(side.allowance[group.vertex], settings_.offset - distance);
  const auto addAt = [&](Index t, const Vec3 &weights, const Vec3 &n, double gap, Index number) {
    SkinContact contact;
    contact.gap = gap + allowance(s, group.vertex);
    if (number == 0) {
      double modulus = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        modulus += weights[static_cast<Eigen::Index>(k)] * other.modulus(surface.triangles[t][k]);
      // Either skin carries half.
      const double ofOwn = own.modulus(group.vertex) / own.spacing(), ofOther = modulus / other.spacing();
      contact.stiffness = 0.5 * settings_.stiffness * std::min(ofOwn, ofOther) * own.skin().areas[group.vertex];
      contact.thickness = settings_.thickness;
    } else {
      contact.gap += settings_.thickness;
    }
    contact.key = keyOf(group.ofSecond ? 1 : 0, group.vertex, number);
    const double side = group.ofSecond ? -1.0 : 1.0;
    // The way of the first seen from the second, along a normal that leads from the second to the first.
    contact.normal = side * n;
    contact.parts[0] = {group.vertex, group.ofSecond, side};
    for (std::size_t k = 0; k < 3; ++k)
      contact.parts[k + 1] = {surface.triangles[t][k], !group.ofSecond, -side * weights[static_cast<Eigen::Index>(k)]};
    add(std::move(contact), gap);
  };
  addAt(at, best.weights, normal, distance - settings_.offset, 0);
  if (!(distance > 0.0)) return;
  // What stands beside it at an angle.
  std::array<Vec3, 4> normals{normal};
  std::size_t count = 1;
  for (Index k = group.begin; k < group.end && count < normals.size(); ++k) {
    const Index t = near_[k];
    if (t == at) continue;
    const NearestOnTriangle found = nearestOn(t);
    // Over its inside; beyond its edges it is nearest to what is beside it.
    if (found.feature != 0 || !(found.squared <= std::pow(room + goes_, 2)) || !(found.squared > 0.0)) continue;
    const Vec3 from = p - placeOn(t, found.weights), n = from.normalized();
    if (!(from.dot(other.faceNormal(t)) > 0.0)) continue;
    if (std::any_of(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Vec3 &known) { return known.dot(n) > kOneSide; }))
      continue;
    normals[count] = n;
    addAt(t, found.weights, n, std::sqrt(found.squared) - settings_.offset, static_cast<Index>(count));
    ++count;
  }
}

void SkinPair::lookAt(EdgePair &pair) {
  MovingSkin &first = *sides_[0].skin, &second = *sides_[1].skin;
  const auto &a = first.skin().edges[pair.first].ends, &b = second.skin().edges[pair.second].ends;
  const NearestOfSegments at =
      nearestOfSegments(first.position(a[0]), first.position(a[1]), second.position(b[0]), second.position(b[1]));
  const Vec3 p = (1.0 - at.onFirst) * first.position(a[0]) + at.onFirst * first.position(a[1]);
  const Vec3 q = (1.0 - at.onSecond) * second.position(b[0]) + at.onSecond * second.position(b[1]);
  const Vec3 way = p - q;
  const double size = way.norm();
  const Vec3 outward = second.edgeNormal(pair.second);
  const double sign = way.dot(outward) >= 0.0 ? 1.0 : -1.0;
  // What overlaps far is a matter of vertices: two edges may pass each other behind the faces.
  const bool overlaps = sign < 0.0 && size <= kDeep * spacing_;
  pair.wake = overlaps ? -std::numeric_limits<double>::infinity() : size - settings_.offset - settings_.margin - went_;
  if (pair.wake > went_ + goes_) return;
  if (sign < 0.0 && !overlaps) return;
  const auto isWithin = [](double part) { return part > kEnds && part < 1.0 - kEnds; };
  if (!isWithin(at.onFirst) || !isWithin(at.onSecond)) return;
  const Vec3 normal = size > kTiny * spacing_ ? Vec3(sign / size * way) : Vec3(outward.normalized());
  const double tolerance = sign > 0.0 ? kCone : 0.0;
  if (!leadsOut(second, pair.second, normal, tolerance) || !leadsOut(first, pair.first, -normal, tolerance)) return;
  SkinContact contact;
  contact.normal = normal;
  const double gap = sign * size - settings_.offset + settings_.thickness;
  double allowed = 0.0;
  for (std::size_t k = 0; k < 2; ++k) allowed = std::max({allowed, allowance(0, a[k]), allowance(1, b[k])});
  contact.gap = gap + allowed;
  contact.key = keyOf(2, pair.first, pair.second);
  contact.parts = {{{a[0], false, 1.0 - at.onFirst},
                    {a[1], false, at.onFirst},
                    {b[0], true, at.onSecond - 1.0},
                    {b[1], true, -at.onSecond}}};
  add(std::move(contact), gap);
}

void SkinPair::add(SkinContact contact, double gap) {
  depth_ = std::max(depth_, -gap - settings_.offset);
  const double left = contact.gap - settings_.margin;
  if (left > goes_ && !isFirst_) return;
  Vec3 velocity = Vec3::Zero();
  for (const SkinContact::Part &part : contact.parts)
    velocity += part.weight * sides_[part.ofSecond ? 1 : 0].skin->velocity(part.vertex);
  const double closes = std::max(0.0, -dt_ * velocity.dot(contact.normal));
  if (left > closes + kCushion * dt_ * velocity.norm() && !isFirst_) return;
  if (!(contact.stiffness > 0.0))
    contact.gap = std::min(contact.gap, std::max(0.0, contact.gap - kCushion * dt_ * velocity.norm()));
  contact.friction = settings_.friction;
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

// By no more than the layer yields under a gentle pressure, and never by more than the overlap there is.
void SkinPair::ease(double &allowance, double overlap) const {
  allowance =
      std::clamp(overlap - settings_.gentle, std::max(0.0, allowance - settings_.ease * dt_), std::max(0.0, allowance));
}

void SkinPair::measureAllowances() {
  if (!(allowed_ > 0.0)) return;
  allowed_ = 0.0;
  for (const Side &side : sides_)
    for (const double allowance : side.allowance) allowed_ = std::max(allowed_, allowance);
  if (!(allowed_ > 0.0))
    for (Side &side : sides_) side.allowance.clear();
}

void SkinPair::setMemory(const Memory &memory) {
  active_ = memory.active;
  for (std::size_t s = 0; s < 2; ++s) {
    sides_[s].allowance = memory.allowances[s];
    sides_[s].isInside = memory.isInside[s];
  }
  allowed_ = memory.allowed;
  isFirst_ = false;
  listed_ = {};
  sum_ = Sum();
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
