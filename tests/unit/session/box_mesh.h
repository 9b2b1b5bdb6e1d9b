// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::session::test {

/// A closed box, faces outwards, mm.
inline geometry::TriangleMesh boxMesh(const Vec3 &low, const Vec3 &high) {
  geometry::TriangleMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back({(corner & 1u) != 0 ? high[0] : low[0], (corner & 2u) != 0 ? high[1] : low[1],
                             (corner & 4u) != 0 ? high[2] : low[2]});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace c3de::session::test
