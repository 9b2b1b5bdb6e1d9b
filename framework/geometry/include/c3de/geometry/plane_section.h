// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::geometry {

/// A curve of a section; closed: the last point is connected to the first.
struct Polyline {
  std::vector<Vec3> points;
  bool isClosed = false;
};

/// Intersection of triangles with a plane, joined to curves. A closed manifold surface gives closed curves only, even
/// when the plane contains vertices or faces (points on the plane count as in front of it). Seen against the normal, a
/// curve around material runs counter-clockwise if the faces are counter-clockwise seen from outside.
/// @param positions  any space; only the sign of the distance to the plane matters, so the result is on the edges
/// @param triangles  indices into positions; invalid ones are ignored
[[nodiscard]] std::vector<Polyline> planeSection(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                                 const Vec3 &planePoint, const Vec3 &planeNormal);
/// Same for single-precision positions for display.
[[nodiscard]] std::vector<Polyline> planeSection(std::span<const std::array<float, 3>> positions,
                                                 std::span<const Triangle> triangles, const Vec3 &planePoint,
                                                 const Vec3 &planeNormal);

/// Signed area of the closed curves, seen against the normal; open ones are closed by a straight line.
[[nodiscard]] double sectionArea(std::span<const Polyline> section, const Vec3 &planeNormal);

}  // namespace c3de::geometry
