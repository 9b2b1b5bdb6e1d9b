// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::geometry {

/// A curve of a section; closed: the last point is joined to the first.
struct Polyline {
  std::vector<Vec3> points;
  bool isClosed = false;
};

/// Where triangles cut a plane, joined to curves. A closed manifold surface gives closed curves only, also when the
/// plane goes through vertices or faces (points on the plane count as in front of it). Seen from where the normal
/// points, a curve around material runs counter-clockwise when the faces are counter-clockwise seen from outside.
/// @param positions  any space; only the sign of the distance to the plane decides, so the result lies on the edges
/// @param triangles  indices into positions; broken ones are left out
[[nodiscard]] std::vector<Polyline> planeSection(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                 const Vec3 &planePoint, const Vec3 &planeNormal);
/// The same for the positions of a screen.
[[nodiscard]] std::vector<Polyline> planeSection(std::span<const std::array<float, 3>> positions,
                                                 std::span<const Triangle> triangles, const Vec3 &planePoint,
                                                 const Vec3 &planeNormal);

/// Signed area of the closed curves as the normal sees them; open ones are closed by a straight line.
[[nodiscard]] double sectionArea(std::span<const Polyline> section, const Vec3 &planeNormal);

}  // namespace c3de::geometry
