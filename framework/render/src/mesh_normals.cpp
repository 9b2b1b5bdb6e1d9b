// SPDX-License-Identifier: Apache-2.0
#include "mesh_normals.h"

#include <cmath>

namespace c3de::render {

void computeVertexNormals(std::span<const Vec3f> positions, std::span<const Triangle> triangles,
                          std::vector<Vec3f> &normals) {
  normals.assign(positions.size(), Vec3f{});
  for (const Triangle &t : triangles) {
    const Vec3f &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
    const Vec3f u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    // The length of the cross product is twice the area, so the sum without normalisation is area-weighted.
    const Vec3f n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (const unsigned vertex : t)
      for (std::size_t k = 0; k < 3; ++k) normals[vertex][k] += n[k];
  }
  for (Vec3f &n : normals) {
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 0.0f)
      for (float &component : n) component /= length;
  }
}

}  // namespace c3de::render
