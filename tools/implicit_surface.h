// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::tools {

/// Negative inside, about the distance in mm near the surface.
using ImplicitFunction = std::function<double(const Vec3 &)>;

/// Closed, manifold triangles on f = 0, faces outwards: marching tetrahedra on a body-centred lattice, then rounds of
/// tangential smoothing with projection back onto the surface.
/// @param box      mm; the surface must lie inside it
/// @param spacing  of the lattice, mm; a triangle has sides of about 0.6 of it
[[nodiscard]] geometry::TriangleMesh polygonise(const ImplicitFunction &f, const geometry::Box &box, double spacing,
                                                int smoothingRounds);

/// Worst ratio of in-circle to circum-circle, times two: 1 is equilateral.
[[nodiscard]] double worstTriangleQuality(const geometry::TriangleMesh &mesh);

}  // namespace c3de::tools
