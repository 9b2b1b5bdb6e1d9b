// SPDX-License-Identifier: Apache-2.0
// What the skins of bodies do that nothing prevents: they reach through walls between points of contact, and into each
// other.
#pragma once

#include "pointbased/body.h"

namespace pointbased {

/// How deep the skin as it is drawn (RestState::surfels) reaches beyond the walls of the box and into closed obstacles,
/// m; 0: nowhere. The points where contact is felt may be well away from it.
/// @param time  s, or load factor: where obstacles that move are
/// @param skin  room for the skin, used again by the next call; without obstacles nothing else is allocated
[[nodiscard]] double skinDepth(const Body &body, std::span<const Obstacle> obstacles, const WorldBox &box, double time,
                               std::vector<Vec3> &skin, const ParallelFor &parallelFor);

/// m, of the point of contact that lies deepest behind the surface through which it came, even where it has come out on
/// the other side; 0: none.
/// @param obstacles  those that ContactState::sides of the body is about
[[nodiscard]] double depthOfPassage(const Body &body, std::span<const Obstacle> obstacles, double time,
                                    const ParallelFor &parallelFor);

/// Where the skins of two bodies overlap, by their points of contact: a point is inside of the other body if it lies
/// behind the plane of that one's nearest point.
struct Overlap {
  double depth = 0.0;      ///< m, deepest point; 0: they do not
  double volume = 0.0;     ///< m³, roughly: area times depth, the mean of both sides
  std::size_t looked = 0;  ///< points of contact that this has cost; 0: their boxes do not meet
};
[[nodiscard]] Overlap overlapOf(const Body &a, const Body &b);

}  // namespace pointbased
