// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edit_mesh.h"

namespace c3de::imaging {

/// Half-edges 3 f of the triangles that another one goes through, ascending. Triangles that share an edge, and those that
/// only touch, count as apart.
[[nodiscard]] std::vector<unsigned> crossedTriangles(const EditMesh &mesh);

}  // namespace c3de::imaging
