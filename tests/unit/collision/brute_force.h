// SPDX-License-Identifier: Apache-2.0
// Brute-force results from every triangle, by formulas other than the tree's.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "c3de/geometry/triangle_mesh.h"

namespace brute_force {

using namespace c3de;  // Vec3 is a std::array: its operators are not found by its type
using geometry::TriangleMesh;

inline double segmentDistance(const Vec3 &p, const Vec3 &a, const Vec3 &b) {
  const Vec3 ab = b - a;
  const double length2 = dot(ab, ab);
  double s = length2 > 0.0 ? dot(p - a, ab) / length2 : 0.0;
  s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
  return norm(p - (a + s * ab));
}

/// Distance to the plane where the foot is inside all three sides, otherwise to the nearest side.
inline double triangleDistance(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const double sides = std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)});
  Vec3 n = cross(b - a, c - a);
  const double length = norm(n);
  if (length < 1e-14) return sides;
  n = (1.0 / length) * n;
  const double height = dot(p - a, n);
  const Vec3 foot = p - height * n;
  const bool inside = dot(cross(b - a, foot - a), n) >= 0.0 && dot(cross(c - b, foot - b), n) >= 0.0 &&
                      dot(cross(a - c, foot - c), n) >= 0.0;
  return inside ? std::abs(height) : sides;
}

inline double distance(const TriangleMesh &mesh, const Vec3 &p) {
  double best = std::numeric_limits<double>::infinity();
  for (const Triangle &t : mesh.triangles)
    best = std::min(best, triangleDistance(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  return best;
}

inline std::vector<std::uint32_t> trianglesInBall(const TriangleMesh &mesh, const Vec3 &p, double radius) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle &t = mesh.triangles[i];
    if (triangleDistance(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]) <= radius)
      found.push_back(i);
  }
  return found;
}

/// Moeller and Trumbore; infinity for a miss.
inline double rayT(const TriangleMesh &mesh, const Vec3 &o, const Vec3 &d) {
  double best = std::numeric_limits<double>::infinity();
  for (const Triangle &t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]], e = mesh.vertices[t[1]] - a, f = mesh.vertices[t[2]] - a;
    const Vec3 p = cross(d, f);
    const double det = dot(e, p);
    if (det == 0.0) continue;
    const Vec3 s = o - a, q = cross(s, e);
    const double u = dot(s, p) / det, v = dot(d, q) / det, hit = dot(f, q) / det;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && hit >= 0.0) best = std::min(best, hit);
  }
  return best;
}

}  // namespace brute_force
