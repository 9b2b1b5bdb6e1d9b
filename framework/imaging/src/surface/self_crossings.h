// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Half-edges 3 f of the triangles that intersect another one, ascending. Triangles that share an edge, or only touch,
/// do not count as intersecting.
[[nodiscard]] std::vector<unsigned> crossedTriangles(const EditMesh &mesh);
/// Only close to triangles with a moved corner.
/// @param moved  [points] not 0: moved
[[nodiscard]] std::vector<unsigned> crossedTriangles(const EditMesh &mesh, std::span<const std::uint8_t> moved);

}  // namespace c3de::imaging
