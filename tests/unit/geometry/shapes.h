// SPDX-License-Identifier: Apache-2.0
// Small closed surfaces for tests.
#pragma once

#include <algorithm>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "c3de/geometry/triangle_mesh.h"

namespace shapes {

using namespace c3de;  // Vec3 is a std::array: its operators are not found by its type
using geometry::TriangleMesh;

/// Axis-aligned box, 12 triangles, faces outwards.
inline TriangleMesh box(const Vec3 &min, const Vec3 &max) {
  TriangleMesh mesh;
  for (unsigned i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 4 ? max[2] : min[2]});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Sphere by subdivision of an octahedron: 8 * 4^levels triangles, vertices exactly on it.
inline TriangleMesh sphere(const Vec3 &centre, double radius, int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middles;
    const auto middle = [&](unsigned a, unsigned b) {
      const auto [it, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<unsigned>(mesh.vertices.size()));
      if (isNew) {
        const Vec3 m = mesh.vertices[a] + mesh.vertices[b];
        mesh.vertices.push_back((1.0 / norm(m)) * m);
      }
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle &t : mesh.triangles) {
      const unsigned ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3 &v : mesh.vertices) v = centre + radius * v;
  return mesh;
}

inline void append(TriangleMesh &to, const TriangleMesh &other) {
  const auto first = static_cast<unsigned>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle &t : other.triangles) to.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline void turnInsideOut(TriangleMesh &mesh) {
  for (Triangle &t : mesh.triangles) std::swap(t[1], t[2]);
}

/// Uniform in a box; the same sequence on every machine.
class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  Vec3 in(const Vec3 &min, const Vec3 &max) {
    return {uniform(min[0], max[0]), uniform(min[1], max[1]), uniform(min[2], max[2])};
  }
  std::size_t index(std::size_t n) { return static_cast<std::size_t>(engine_()) % n; }

 private:
  std::mt19937 engine_;
};

}  // namespace shapes
