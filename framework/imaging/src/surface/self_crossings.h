// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/edit_mesh.h"

namespace c3de::imaging {

/// Half-edges 3 f of the triangles that another one goes through, ascending. Triangles that share an edge, and those
/// that only touch, count as apart.
[[nodiscard]] std::vector<unsigned> crossedTriangles(const EditMesh &mesh);
/// Only near triangles with a corner that has moved.
/// @param moved  [points] not 0: it has
[[nodiscard]] std::vector<unsigned> crossedTriangles(const EditMesh &mesh, std::span<const std::uint8_t> moved);

}  // namespace c3de::imaging
