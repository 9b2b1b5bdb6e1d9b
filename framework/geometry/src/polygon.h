// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::geometry {

/// Appends corners.size() - 2 triangles that cover the polygon: the better diagonal of a quadrilateral, ear clipping
/// for more corners. Concave polygons are correct if they are approximately flat and do not intersect themselves.
/// @pre  at least three corners, indices in range
/// @returns false for a concave polygon with more than 4096 corners; nothing is appended then
[[nodiscard]] bool triangulatePolygon(std::span<const Vec3> vertices, std::span<const unsigned> corners,
                                      std::vector<Triangle> &out);

}  // namespace c3de::geometry
