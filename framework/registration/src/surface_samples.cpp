// SPDX-License-Identifier: Apache-2.0
#include "c3de/registration/surface_samples.h"

#include <cmath>

namespace c3de::registration {

SurfaceSamples sampleSurface(const geometry::TriangleMesh &mesh, std::size_t count) {
  SurfaceSamples out;
  const double total = surfaceArea(mesh);
  if (!(total > 0.0)) return out;
  // Steps of the additive sequence R2 in the unit square: 1/g and 1/g^2 with g^3 = g + 1.
  constexpr double kStepU = 0.7548776662466927, kStepV = 0.5698402909980532;
  double before = 0.0;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 across = cross(b - a, c - a);
    const double area = 0.5 * norm(across), end = before + area;
    while (out.points.size() < count &&
           (static_cast<double>(out.points.size()) + 0.5) * total < end * static_cast<double>(count)) {
      const auto i = static_cast<double>(out.points.size() + 1);
      double u = i * kStepU - std::floor(i * kStepU), v = i * kStepV - std::floor(i * kStepV);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      out.points.push_back(a + u * (b - a) + v * (c - a));
      out.normals.push_back((0.5 / area) * across);
    }
    before = end;
  }
  return out;
}

}  // namespace c3de::registration
