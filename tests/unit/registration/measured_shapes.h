// SPDX-License-Identifier: Apache-2.0
// Bodies, and points as an instrument would measure them.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "c3de/geometry/rigid_fit.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/registration/rigid_registration.h"
#include "c3de/registration/surface_samples.h"

namespace measured_shapes {

using namespace c3de;  // Vec3 is a std::array: its operators are not found by its type
using geometry::TriangleMesh;

/// Sphere of radius 1 by subdivision of an octahedron: 8 * 4^levels triangles.
inline TriangleMesh unitSphere(int levels) {
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
  return mesh;
}

/// An organ without symmetry, some 200 x 130 x 100 mm: 8 * 4^levels triangles (6: 32768).
inline TriangleMesh organ(int levels = 5) {
  TriangleMesh mesh = unitSphere(levels);
  for (Vec3 &v : mesh.vertices) {
    const double x = v[0], y = v[1], z = v[2];
    const double r = 1.0 + 0.25 * x + 0.12 * std::sin(2.5 * x + 1.0) * y + 0.15 * std::cos(3.0 * z + x) * x +
                     0.1 * std::sin(3.0 * y - 2.0 * z) + 0.08 * x * y * z * 3.0;
    v = {85.0 * r * x + 12.0, 60.0 * r * y - 30.0, 45.0 * r * z + 140.0};
  }
  return mesh;
}

inline TriangleMesh ellipsoid(const Vec3 &radii, int levels = 5) {
  TriangleMesh mesh = unitSphere(levels);
  for (Vec3 &v : mesh.vertices) v = {radii[0] * v[0], radii[1] * v[1], radii[2] * v[2]};
  return mesh;
}

/// Points on the part of a surface that faces a direction, uniform by area, with Gaussian noise.
struct Measurement {
  std::size_t points = 500;
  double share = 0.25;  ///< of the area
  Vec3 towards{0.3, 0.5, 0.8};
  double noise_mm = 1.0;
  double outliers = 0.0;  ///< share of the points, uniform in the box of the body
  unsigned seed = 7;
};

inline std::vector<Vec3> measure(const TriangleMesh &body, const Measurement &how, const Mat4 &motion) {
  std::mt19937 random(how.seed);
  std::normal_distribution<double> gauss(0.0, how.noise_mm);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto samples = registration::sampleSurface(body, 20000);
  std::vector<std::size_t> order(samples.points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return dot(samples.points[a], how.towards) > dot(samples.points[b], how.towards);
  });
  order.resize(std::max<std::size_t>(1, static_cast<std::size_t>(how.share * 20000.0)));
  std::shuffle(order.begin(), order.end(), random);
  const geometry::Box box = boundingBox(body);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < how.points; ++i) {
    Vec3 p{};
    if (static_cast<double>(i) < how.outliers * static_cast<double>(how.points)) {
      for (std::size_t a = 0; a < 3; ++a) p[a] = box.min[a] + uniform(random) * (box.max[a] - box.min[a]);
    } else {
      const std::size_t s = order[i % order.size()];
      p = samples.points[s] + gauss(random) * samples.normals[s];
    }
    out.push_back(transformPoint(motion, p));
  }
  return out;
}

/// Rotation and translation far from the identity; another one for each number.
inline Mat4 someMotion(unsigned number) {
  std::mt19937 random(number);
  std::uniform_real_distribution<double> angle(-180.0, 180.0), length(-300.0, 300.0);
  geometry::RigidPose pose;
  for (std::size_t a = 0; a < 3; ++a) pose.rotation_deg[a] = angle(random), pose.translation_mm[a] = length(random);
  return matrixOf(pose);
}

/// Largest distance of the images of the body's vertices.
inline double errorOf(const TriangleMesh &body, const Mat4 &a, const Mat4 &b) {
  double most = 0.0;
  for (const Vec3 &v : body.vertices) most = std::max(most, norm(transformPoint(a, v) - transformPoint(b, v)));
  return most;
}

}  // namespace measured_shapes
