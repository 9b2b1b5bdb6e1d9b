// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::registration {

/// Points on a surface, each with the unit normal of its triangle.
struct SurfaceSamples {
  std::vector<Vec3> points, normals;
};

/// `count` points that are uniform by area: one in the middle of each equal share of the area, in the order of the
/// triangles, at quasi-random positions in them. The same for the same mesh. Empty for a surface without area. Any
/// thread.
[[nodiscard]] SurfaceSamples sampleSurface(const geometry::TriangleMesh &mesh, std::size_t count);

}  // namespace c3de::registration
