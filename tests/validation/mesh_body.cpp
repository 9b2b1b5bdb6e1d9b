// SPDX-License-Identifier: Apache-2.0
#include "mesh_body.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/winding_number.h"

namespace validation {

using pointbased::BodyShape;
using pointbased::Vec3;

BodyShape meshShape(const pointbased::Surface &surface) {
  c3de::geometry::TriangleMesh placed;
  for (const Vec3 &x : surface.positions) placed.vertices.push_back({x[0], x[1], x[2]});
  for (const auto &[a, b, c] : surface.triangles) placed.triangles.push_back({a, b, c});
  auto built = c3de::collision::AabbTree::build(placed.vertices, placed.triangles);
  if (!built) throw std::runtime_error(built.error().message);
  const auto tree = std::make_shared<const c3de::collision::AabbTree>(std::move(*built));
  const auto winding = std::make_shared<const c3de::geometry::WindingNumber>(placed);
  const auto at = [](const Vec3 &x) { return c3de::Vec3{x[0], x[1], x[2]}; };

  BodyShape shape;
  shape.min = shape.max = surface.positions.front();
  for (const Vec3 &x : surface.positions) {
    shape.min = shape.min.cwiseMin(x);
    shape.max = shape.max.cwiseMax(x);
  }
  shape.volume = std::abs(c3de::geometry::signedVolume(placed));
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = winding->at(at(points[i]));
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(tree->closest(at(points[i])).distance);
  };
  shape.crosses = [=](std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses) {
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = tree->segment(at(from[i]), at(to[i])).isHit() ? 1 : 0;
  };
  shape.surface = surface;
  return shape;
}

BodyShape meshShape(const std::filesystem::path &file, c3de::geometry::LengthUnit unit, double width, double lowest) {
  auto loaded = c3de::geometry::loadMesh(file, unit);
  if (!loaded) throw std::runtime_error(loaded.error().message);
  const c3de::geometry::Box box = loaded->report.box;
  const Vec3 low(box.min[0], box.min[1], box.min[2]), high(box.max[0], box.max[1], box.max[2]);
  const double scale = width / (high - low).maxCoeff();
  const Vec3 middle = 0.5 * (low + high), foot(middle[0], low[1], middle[2]);
  // The core uses metres in the frame of the body's position.
  pointbased::Surface placed;
  for (const c3de::Vec3 &v : loaded->mesh.vertices)
    placed.positions.push_back(scale * (Vec3(v[0], v[1], v[2]) - foot) + Vec3(0.0, lowest, 0.0));
  for (const c3de::Triangle &t : loaded->mesh.triangles) placed.triangles.push_back({t[0], t[1], t[2]});
  return meshShape(placed);
}

}  // namespace validation
