// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/triangle_mesh.h"

#include <algorithm>

namespace c3de::geometry {

double millimetresPer(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::metre: return 1000.0;
    case LengthUnit::centimetre: return 10.0;
    case LengthUnit::millimetre: break;
  }
  return 1.0;
}

const char *unitName(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::metre: return "m";
    case LengthUnit::centimetre: return "cm";
    case LengthUnit::millimetre: break;
  }
  return "mm";
}

Box boundingBox(const TriangleMesh &mesh) {
  if (mesh.vertices.empty()) return {};
  Box box{mesh.vertices.front(), mesh.vertices.front()};
  for (const Vec3 &v : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) {
      box.min[k] = std::min(box.min[k], v[k]);
      box.max[k] = std::max(box.max[k], v[k]);
    }
  return box;
}

double signedVolume(const TriangleMesh &mesh) {
  // Relative to the centre of the box: an organ far from the origin of its scan would otherwise lose precision, and a
  // small hole then changes the result little.
  const Box box = boundingBox(mesh);
  const Vec3 centre = 0.5 * (box.min + box.max);
  double sum = 0.0;
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - centre, b = mesh.vertices[t[1]] - centre, c = mesh.vertices[t[2]] - centre;
    sum += dot(a, cross(b, c));
  }
  return sum / 6.0;
}

double surfaceArea(const TriangleMesh &mesh) {
  double sum = 0.0;
  for (const Triangle &t : mesh.triangles)
    sum += norm(cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]));
  return 0.5 * sum;
}

std::vector<Vec3> vertexNormals(const TriangleMesh &mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3{});
  for (const Triangle &t : mesh.triangles) {
    const Vec3 n = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (unsigned v : t) normals[v] = normals[v] + n;
  }
  for (Vec3 &n : normals) {
    const double length = norm(n);
    n = length > 0.0 ? (1.0 / length) * n : Vec3{0.0, 0.0, 1.0};
  }
  return normals;
}

}  // namespace c3de::geometry
