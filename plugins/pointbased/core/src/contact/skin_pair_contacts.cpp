// SPDX-License-Identifier: Apache-2.0
// Closest features of two skins: vertex and face, edge and edge. Candidates are gathered in skin_pair.cpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/contact_search.h"
#include "contact/contact_tolerances.h"
#include "contact/skin_pair.h"

namespace pointbased::detail {
namespace {

std::uint64_t keyOf(int kind, Index a, Index b) {
  return (static_cast<std::uint64_t>(kind) << 62) | (static_cast<std::uint64_t>(a) << 31) | b;
}

// Whether a direction points out of the wedge of faces around an edge.
bool pointsOutOfWedge(MovingSkin &skin, Index edge, const Vec3 &direction, double tolerance) {
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

// Whether a neighbour of a vertex on its own skin is so much closer to a face with this normal that the vertex cannot
// touch that face.
bool isOccluded(MovingSkin &skin, Index vertex, const Vec3 &normal) {
  const Vec3 x = skin.position(vertex);
  for (const Index t : skin.skin().trianglesOf.row(vertex))
    for (const Index other : skin.skin().triangles[t]) {
      const Vec3 edge = skin.position(other) - x;
      if (-edge.dot(normal) > kOcclusionSine * edge.norm()) return true;
    }
  return false;
}

}  // namespace

void SkinPair::updateVertexContact(VertexCandidates &group) {
  const std::span<const VertexFacePair> candidates =
      std::span<const VertexFacePair>(vertexFacePairs_).subspan(group.begin, group.end - group.begin);
  const Index vertex = candidates.front().vertex;
  const std::size_t s = candidates.front().ofSecond ? 1 : 0;
  MovingSkin &own = *skins_[s].skin, &other = *skins_[1 - s].skin;
  const Vec3 p = own.position(vertex);
  Index triangle = candidates.front().triangle;
  NearestOnTriangle best = other.nearestOn(triangle, p);
  for (const VertexFacePair &one : candidates.subspan(1))
    if (const NearestOnTriangle found = other.nearestOn(one.triangle, p); found.squared < best.squared) {
      best = found;
      triangle = one.triangle;
    }
  const double length = std::sqrt(best.squared), contactDistance = settings_.offset + settings_.margin;
  std::uint8_t &isInside = skins_[s].isInside[vertex];
  Vec3 velocity = own.velocity(vertex);
  for (std::size_t k = 0; k < 3; ++k)
    velocity -= best.weights[static_cast<Eigen::Index>(k)] * other.velocity(other.skin().triangles[triangle][k]);
  const double within = contactDistance + dt_ * velocity.norm();
  group.idleTravel =
      isInside == 0 ? length - contactDistance - travelSinceGather_ : -std::numeric_limits<double>::infinity();
  if (isInside == 0 && length > within) return;
  const Vec3 separation = p - other.pointOn(triangle, best.weights);
  const Vec3 outward = other.featureNormal(triangle, best.feature);
  const double sign = separation.dot(outward) >= 0.0 ? 1.0 : -1.0;
  // A vertex that has not entered near the surface is not inside. For a skin with itself the nearest triangles are
  // excluded, and a crushed skin may be inverted.
  if (sign < 0.0 && length > kDeepOverlap * spacing_ && (isSelf() || isInside == 0)) return;
  isInside = sign < 0.0 ? 1 : 0;
  FacePoint at{triangle, best.weights,
               length > kMinDirectionLength * spacing_ ? Vec3(sign / length * separation) : Vec3(outward.normalized()),
               sign * length};
  const bool slidesFar = at.distance > 0.0 && dt_ * velocity.norm() > kLargeSlide * settings_.offset;
  if (stepKind_ != StepKind::explicitStep && (at.distance > contactDistance || slidesFar)) {
    const FacePoint crossed = at.distance > contactDistance ? firstCrossing(candidates) : faceAtEnd(candidates);
    if (crossed.triangle != kNoTriangle)
      at = crossed;
    else if (at.distance > contactDistance)
      return;
  }
  if (isSelf() && !(own.areaWeightedNormal(vertex).dot(at.normal) < kMaxFacingCosine)) return;

  const double offset = layerOffset(candidates.front(), at.triangle);
  // Vertices that do not overlap recover their full layer at any pressure.
  if (PairedSkin &side = skins_[s]; isInside != 0 && !side.initialPenetration.empty())
    restoreInitialPenetration(side.initialPenetration[vertex], offset - at.distance);
  // If the layer is restored at once, without time, friction must not strain it.
  const bool restoresLayer = stepKind_ == StepKind::quasiStatic && at.distance >= 0.0 && toleratedBefore_ > 0.0 &&
                             resolvesInitialOverlap() && offset > at.distance;
  const double friction = restoresLayer ? 0.0 : settings_.friction;
  addVertexContact(candidates.front(), at, 0, friction);
  if (at.distance > 0.0 && (stepKind_ == StepKind::explicitStep || length <= contactDistance))
    addNeighbouringFaces(candidates, at, within, friction);
}

double SkinPair::layerOffset(const VertexFacePair &of, Index triangle) const {
  const std::size_t s = of.ofSecond ? 1 : 0;
  const auto &[a, b, c] = skins_[1 - s].skin->skin().triangles[triangle];
  return settings_.offset * std::min(refinementFactor(s, of.vertex), refinementFactor(1 - s, a, b, c));
}

void SkinPair::addVertexContact(const VertexFacePair &of, const FacePoint &at, Index number, double friction) {
  const std::size_t s = of.ofSecond ? 1 : 0;
  MovingSkin &own = *skins_[s].skin, &other = *skins_[1 - s].skin;
  const std::array<Index, 3> &corners = other.skin().triangles[at.triangle];
  const double offset = layerOffset(of, at.triangle), thickness = offset / settings_.offset * settings_.thickness;
  const double tolerated = initialPenetration(s, of.vertex);
  SkinContact contact;
  contact.gap = at.distance - offset + tolerated;
  if (number == 0 && own.skin().areas[of.vertex] > 0.0) {
    double modulus = 0.0;
    for (std::size_t k = 0; k < 3; ++k) modulus += at.weights[static_cast<Eigen::Index>(k)] * other.modulus(corners[k]);
    // Each skin contributes half of the layer.
    const double ofOwn = own.modulus(of.vertex) / own.spacingAt(of.vertex),
                 ofOther = modulus / other.spacingAt(corners[0]);
    contact.stiffness = 0.5 * settings_.stiffness * std::min(ofOwn, ofOther) * own.skin().areas[of.vertex];
    contact.thickness = thickness;
  } else {
    contact.gap += thickness;
  }
  contact.key = keyOf(of.ofSecond ? 1 : 0, of.vertex, number);
  contact.friction = friction;
  const double sign = of.ofSecond ? -1.0 : 1.0;
  // Displacement of the first skin relative to the second, along a normal that points from the second to the first.
  contact.normal = sign * at.normal;
  contact.parts[0] = {of.vertex, of.ofSecond, sign};
  for (std::size_t k = 0; k < 3; ++k)
    contact.parts[k + 1] = {corners[k], !of.ofSecond, -sign * at.weights[static_cast<Eigen::Index>(k)]};
  add(std::move(contact), skins_[s].isInside[of.vertex] != 0 ? at.distance : std::max(at.distance, 0.0), tolerated);
}

// Further faces near the vertex, at an angle to the first.
void SkinPair::addNeighbouringFaces(std::span<const VertexFacePair> candidates, const FacePoint &first, double within,
                                    double friction) {
  const std::size_t s = candidates.front().ofSecond ? 1 : 0;
  MovingSkin &other = *skins_[1 - s].skin;
  const Vec3 p = skins_[s].skin->position(candidates.front().vertex);
  std::array<Vec3, 4> normals{first.normal};
  std::size_t count = 1;
  for (const VertexFacePair &one : candidates) {
    if (count == normals.size()) break;
    // Only where the vertex is above the interior; outside of it the nearest feature belongs to a neighbour.
    if (one.triangle == first.triangle) continue;
    const NearestOnTriangle found = other.nearestOn(one.triangle, p);
    if (found.feature != 0 || !(found.squared > 0.0) || !(found.squared <= within * within)) continue;
    const Vec3 from = p - other.pointOn(one.triangle, found.weights), n = from.normalized();
    if (!(from.dot(other.faceNormal(one.triangle)) > 0.0)) continue;
    if (std::any_of(normals.begin(), normals.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const Vec3 &known) { return known.dot(n) > kDuplicateNormalCosine; }))
      continue;
    normals[count] = n;
    addVertexContact(one, {one.triangle, found.weights, n, std::sqrt(found.squared)}, static_cast<Index>(count),
                     friction);
    ++count;
  }
}

SkinPair::FacePoint SkinPair::firstCrossing(std::span<const VertexFacePair> candidates) const {
  const std::size_t s = candidates.front().ofSecond ? 1 : 0;
  MovingSkin &own = *skins_[s].skin, &other = *skins_[1 - s].skin;
  const Vec3 p = own.position(candidates.front().vertex), stepTravel = dt_ * own.velocity(candidates.front().vertex);
  FacePoint first;
  double earliest = std::numeric_limits<double>::infinity();
  for (const VertexFacePair &one : candidates) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const NearestOnTriangle atStart = other.nearestOn(one.triangle, p);
    const std::array<Vec3, 3> travel{dt_ * other.velocity(a), dt_ * other.velocity(b), dt_ * other.velocity(c)};
    const double distanceAtStart = n.dot(p - other.position(a));
    Vec3 relativeTravel = stepTravel;
    for (std::size_t k = 0; k < 3; ++k) relativeTravel -= atStart.weights[static_cast<Eigen::Index>(k)] * travel[k];
    const double distanceAtEnd = distanceAtStart + n.dot(relativeTravel);
    if (!(distanceAtStart > 0.0) || !(distanceAtEnd < settings_.offset)) continue;
    // Time at which the vertex passes the plane of the face, as part of the step; 1: it ends before the plane.
    const double fraction = distanceAtEnd < 0.0 ? distanceAtStart / (distanceAtStart - distanceAtEnd) : 1.0;
    const NearestOnTriangle closest =
        nearestOnTriangle(p + fraction * stepTravel, other.position(a) + fraction * travel[0],
                          other.position(b) + fraction * travel[1], other.position(c) + fraction * travel[2]);
    const double tolerance = std::max(kCrossingTolerance * settings_.offset, distanceAtEnd);
    if (!(closest.squared <= tolerance * tolerance) || !(fraction < earliest)) continue;
    earliest = fraction;
    first = {one.triangle, closest.weights, n, distanceAtStart};
  }
  // A floor vertex ahead of a block that sinks in before its contacts are found crosses the front of the block. The
  // face above which it ends is the one that separates the two.
  if (first.triangle != kNoTriangle && isOccluded(own, candidates.front().vertex, first.normal))
    if (const FacePoint aboveAtEnd = faceAtEnd(candidates); aboveAtEnd.triangle != kNoTriangle) return aboveAtEnd;
  return first;
}

// A vertex outside of an edge at the beginning of a step may be above a face at its end.
SkinPair::FacePoint SkinPair::faceAtEnd(std::span<const VertexFacePair> candidates) const {
  const std::size_t s = candidates.front().ofSecond ? 1 : 0;
  MovingSkin &own = *skins_[s].skin, &other = *skins_[1 - s].skin;
  const auto endOf = [&](MovingSkin &skin, Index v) { return Vec3(skin.position(v) + dt_ * skin.velocity(v)); };
  const Vec3 p = own.position(candidates.front().vertex), end = endOf(own, candidates.front().vertex);
  FacePoint aboveAtEnd;
  double nearest = std::numeric_limits<double>::infinity();
  for (const VertexFacePair &one : candidates) {
    const auto &[a, b, c] = other.skin().triangles[one.triangle];
    const std::array<Vec3, 3> ends{endOf(other, a), endOf(other, b), endOf(other, c)};
    const NearestOnTriangle found = nearestOnTriangle(end, ends[0], ends[1], ends[2]);
    const Vec3 n = other.faceNormal(one.triangle).normalized();
    const double distanceAtStart = n.dot(p - other.position(a));
    // Ahead of a body, the plane of a slightly rotated face may be behind the vertex.
    if (!(found.squared < nearest) || !(distanceAtStart > -kNormalConeTolerance * (p - other.position(a)).norm()))
      continue;
    // On the border of two faces the vertex is above both of them.
    const Vec3 off = end - found.weights[0] * ends[0] - found.weights[1] * ends[1] - found.weights[2] * ends[2];
    if (found.feature != 0 &&
        !(tangential(off, n).norm() <= kNormalConeTolerance * off.norm() + kMinDirectionLength * spacing_))
      continue;
    // Its own skin faces that face. Along a side that both bodies have in one plane it does not.
    if (isOccluded(own, candidates.front().vertex, n) || !(own.vertexNormal(candidates.front().vertex).dot(n) < 0.0))
      continue;
    nearest = found.squared;
    aboveAtEnd = {one.triangle, found.weights, n, distanceAtStart};
  }
  return aboveAtEnd;
}

void SkinPair::updateEdgeContact(EdgeCandidates &pair) {
  MovingSkin &first = *skins_[0].skin, &second = *skins_[1].skin;
  const auto &a = first.skin().edges[pair.first].ends, &b = second.skin().edges[pair.second].ends;
  const NearestOfSegments at =
      nearestOfSegments(first.position(a[0]), first.position(a[1]), second.position(b[0]), second.position(b[1]));
  const Vec3 p = (1.0 - at.onFirst) * first.position(a[0]) + at.onFirst * first.position(a[1]);
  const Vec3 q = (1.0 - at.onSecond) * second.position(b[0]) + at.onSecond * second.position(b[1]);
  const Vec3 separation = p - q;
  const double length = separation.norm();
  const double contactDistance = settings_.offset + settings_.margin;
  pair.idleTravel = length - contactDistance - travelSinceGather_;
  if (length - contactDistance > stepTravel_) return;
  const Vec3 outward = second.edgeNormal(pair.second);
  const double sign = separation.dot(outward) >= 0.0 ? 1.0 : -1.0;
  // Deep overlap is left to the vertices: two edges may pass each other behind the faces.
  if (sign < 0.0 && length > kDeepOverlap * spacing_) return;
  if (isSelf()) {
    const std::vector<Vec3> &rest = first.skin().vertices.positions;
    const auto between = [&](const std::array<Index, 2> &ends, double fraction) {
      return Vec3((1.0 - fraction) * rest[ends[0]] + fraction * rest[ends[1]]);
    };
    if (areSameTissue(between(a, at.onFirst), between(b, at.onSecond))) return;
  }
  const auto isWithin = [](double fraction) {
    return fraction > kEdgeEndTolerance && fraction < 1.0 - kEdgeEndTolerance;
  };
  if (!isWithin(at.onFirst) || !isWithin(at.onSecond)) return;
  const Vec3 normal =
      length > kMinDirectionLength * spacing_ ? Vec3(sign / length * separation) : Vec3(outward.normalized());
  const double refined = std::min(refinementFactor(0, a[0], a[1]), refinementFactor(1, b[0], b[1]));
  if (stepKind_ != StepKind::explicitStep && sign * length > contactDistance) {
    // Do the edges pass each other within the step?
    const auto endOf = [&](MovingSkin &skin, Index v) { return Vec3(skin.position(v) + dt_ * skin.velocity(v)); };
    const Vec3 a0 = endOf(first, a[0]), a1 = endOf(first, a[1]), b0 = endOf(second, b[0]), b1 = endOf(second, b[1]);
    const NearestOfSegments then = nearestOfSegments(a0, a1, b0, b1);
    const Vec3 off = (1.0 - then.onFirst) * a0 + then.onFirst * a1 - (1.0 - then.onSecond) * b0 - then.onSecond * b1;
    if (!isWithin(then.onFirst) || !isWithin(then.onSecond) || !(off.dot(normal) < refined * settings_.offset)) return;
  }
  const double tolerance = sign > 0.0 ? kNormalConeTolerance : 0.0;
  if (!pointsOutOfWedge(second, pair.second, normal, tolerance) ||
      !pointsOutOfWedge(first, pair.first, -normal, tolerance))
    return;
  SkinContact contact;
  contact.normal = normal;
  const double distance = sign * length;
  double tolerated = 0.0;
  for (std::size_t k = 0; k < 2; ++k)
    tolerated = std::max({tolerated, initialPenetration(0, a[k]), initialPenetration(1, b[k])});
  contact.gap = distance - refined * (settings_.offset - settings_.thickness) + tolerated;
  contact.key = keyOf(2, pair.first, pair.second);
  contact.friction = settings_.friction;
  contact.parts = {{{a[0], false, 1.0 - at.onFirst},
                    {a[1], false, at.onFirst},
                    {b[0], true, at.onSecond - 1.0},
                    {b[1], true, -at.onSecond}}};
  add(std::move(contact), distance, tolerated);
}

void SkinPair::add(SkinContact contact, double distance, double tolerated) {
  // The skin of an inverted body has no outside.
  if (isSelf() && std::any_of(contact.parts.begin(), contact.parts.end(), [&](const SkinContact::Part &part) {
        return part.weight != 0.0 && skins_[0].skin->isInverted(part.vertex);
      }))
    return;
  depth_ = std::max(depth_, -distance - (resolvesInitialOverlap() ? 0.0 : tolerated));
  const double remainingGap = contact.gap - settings_.margin;
  Vec3 velocity = Vec3::Zero();
  for (const SkinContact::Part &part : contact.parts)
    velocity += part.weight * skins_[part.ofSecond ? 1 : 0].skin->velocity(part.vertex);
  const double approach = std::max(0.0, -dt_ * velocity.dot(contact.normal));
  if (remainingGap > approach + kSpeedMargin * dt_ * velocity.norm() && !isFirstSearch_) return;
  if (!(contact.stiffness > 0.0))
    contact.gap = std::min(contact.gap, std::max(0.0, contact.gap - kSpeedMargin * dt_ * velocity.norm()));
  active_.push_back(std::move(contact));
}

// Overlap found by the first find() is tolerated, and reduced slowly.
void SkinPair::recordInitialPenetration() {
  for (SkinContact &contact : active_) {
    if (!(contact.gap < 0.0)) continue;
    for (const SkinContact::Part &part : contact.parts) {
      PairedSkin &side = skins_[part.ofSecond ? 1 : 0];
      if (side.initialPenetration.empty()) side.initialPenetration.assign(side.skin->skin().count(), 0.0);
      side.initialPenetration[part.vertex] = std::max(side.initialPenetration[part.vertex], -contact.gap);
      if (!contact.isOfEdges()) break;  // for vertex against face, the vertex stores it
    }
    toleratedOverlap_ = std::max(toleratedOverlap_, -contact.gap);
    contact.gap = 0.0;
  }
}

// Reduces all tolerated overlap. restoreInitialPenetration() restores it where the layer would be compressed too much.
void SkinPair::relaxInitialPenetration() {
  if (!reducesOverlap_ || !resolvesInitialOverlap() || !(toleratedOverlap_ > 0.0)) return;
  overlapReduced_ = true;
  toleratedOverlap_ = 0.0;
  for (PairedSkin &side : skins_)
    for (double &initialPenetration : side.initialPenetration) {
      initialPenetration = std::max(0.0, initialPenetration - settings_.recoverySpeed * dt_);
      toleratedOverlap_ = std::max(toleratedOverlap_, initialPenetration);
    }
  if (!(toleratedOverlap_ > 0.0))
    for (PairedSkin &side : skins_) side.initialPenetration.clear();
}

void SkinPair::restoreInitialPenetration(double &initialPenetration, double overlap) const {
  if (reducesOverlap_ && initialPenetration > 0.0)
    initialPenetration = std::clamp(overlap - settings_.recoveryCompression, initialPenetration,
                                    initialPenetration + settings_.recoverySpeed * dt_);
}

void SkinPair::updateActive() {
  invalidateSearch();  // gaps remain those of the beginning of the step
  for (SkinContact &contact : active_) {
    if (!(contact.normalImpulse > 0.0)) continue;
    const auto at = [&](std::size_t k) {
      const SkinContact::Part &part = contact.parts[k];
      return skins_[part.ofSecond ? 1 : 0].skin->position(part.vertex);
    };
    std::array<double, 4> weights{};
    if (contact.isOfEdges()) {
      const NearestOfSegments closest = nearestOfSegments(at(0), at(1), at(2), at(3));
      weights = {1.0 - closest.onFirst, closest.onFirst, closest.onSecond - 1.0, -closest.onSecond};
    } else {
      const double sign = contact.parts[0].weight;
      const NearestOnTriangle closest = nearestOnTriangle(at(0), at(1), at(2), at(3));
      weights = {sign, -sign * closest.weights[0], -sign * closest.weights[1], -sign * closest.weights[2]};
    }
    Vec3 separation = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) separation += weights[k] * at(k);
    const double length = separation.norm();
    if (!(length > kMinDirectionLength * spacing_)) continue;
    const Vec3 normal = (separation.dot(contact.normal) >= 0.0 ? 1.0 : -1.0) / length * separation;
    // The normal belongs to another face: the next search finds it.
    if (normal.dot(contact.normal) < kSamePlaneCosine) continue;
    for (std::size_t k = 0; k < 4; ++k) contact.parts[k].weight = weights[k];
    contact.normal = normal;
    contact.frictionImpulse = tangential(contact.frictionImpulse, normal);
    contact.projectionFriction = tangential(contact.projectionFriction, normal);
  }
}

}  // namespace pointbased::detail
