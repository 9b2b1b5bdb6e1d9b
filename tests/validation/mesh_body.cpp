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

BodyShape meshShape(const std::filesystem::path &file, c3de::geometry::LengthUnit unit, double width, double lowest) {
  auto loaded = c3de::geometry::loadMesh(file, unit);
  if (!loaded) throw std::runtime_error(loaded.error().message);
  const c3de::geometry::Box box = loaded->report.box;
  const Vec3 low(box.min[0], box.min[1], box.min[2]), high(box.max[0], box.max[1], box.max[2]);
  const double scale = width / (high - low).maxCoeff();
  const Vec3 middle = 0.5 * (low + high), foot(middle[0], low[1], middle[2]);

  // The core sees metres where the body stands; tree and winding numbers are of that, too.
  c3de::geometry::TriangleMesh placed;
  for (const c3de::Vec3 &v : loaded->mesh.vertices) {
    const Vec3 x = scale * (Vec3(v[0], v[1], v[2]) - foot) + Vec3(0.0, lowest, 0.0);
    placed.vertices.push_back({x[0], x[1], x[2]});
  }
  placed.triangles = loaded->mesh.triangles;
  auto tree = c3de::collision::AabbTree::build(placed.vertices, placed.triangles);
  if (!tree) throw std::runtime_error(tree.error().message);
  const auto surface = std::make_shared<const c3de::collision::AabbTree>(std::move(*tree));
  const auto winding = std::make_shared<const c3de::geometry::WindingNumber>(placed);
  const auto at = [](const Vec3 &x) { return c3de::Vec3{x[0], x[1], x[2]}; };

  BodyShape shape;
  shape.min = scale * (low - foot) + Vec3(0.0, lowest, 0.0);
  shape.max = scale * (high - foot) + Vec3(0.0, lowest, 0.0);
  shape.volume = std::abs(c3de::geometry::signedVolume(placed));
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = winding->at(at(points[i]));
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(surface->closest(at(points[i])).distance);
  };
  shape.crosses = [=](std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses) {
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = surface->segment(at(from[i]), at(to[i])).isHit() ? 1 : 0;
  };
  for (const c3de::Vec3 &v : placed.vertices) shape.surface.positions.emplace_back(v[0], v[1], v[2]);
  for (const c3de::Triangle &t : placed.triangles) shape.surface.triangles.push_back({t[0], t[1], t[2]});
  return shape;
}

}  // namespace validation
