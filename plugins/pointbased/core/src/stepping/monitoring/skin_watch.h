// SPDX-License-Identifier: Apache-2.0
// Checks of the skins of bodies for what contact does not prevent: penetration of walls between contact points, and of
// each other.
#pragma once

#include "pointbased/body.h"

namespace pointbased {

/// Depth of the displayed skin (RestState::surfels) beyond the walls of the box and in closed obstacles, m; 0: none.
/// Contact points may be well away from it.
/// @param time  s, or load factor: determines the pose of moving obstacles
/// @param skin  scratch, reusable; without obstacles nothing else is allocated
[[nodiscard]] double skinDepth(const Body &body, std::span<const Obstacle> obstacles, const WorldBox &box, double time,
                               std::vector<Vec3> &skin, const ParallelFor &parallelFor);

/// m, largest depth of a contact point behind the surface through which it has passed, even if it has come out on the
/// other side; 0: none.
/// @param obstacles  those to which ContactState::lastOutside of the body refers
[[nodiscard]] double depthOfPassage(const Body &body, std::span<const Obstacle> obstacles, double time,
                                    const ParallelFor &parallelFor);

/// Overlap of the skins of two bodies, from their contact points: a point is inside of the other body if it is behind
/// the plane of that body's nearest point.
struct Overlap {
  double depth = 0.0;             ///< m, deepest point; 0: no overlap
  double volume = 0.0;            ///< m³, approximate: area times depth, the mean of both sides
  std::size_t checkedPoints = 0;  ///< contact points that were checked; 0: the bounding boxes do not meet
};
[[nodiscard]] Overlap overlapOf(const Body &a, const Body &b);

}  // namespace pointbased
