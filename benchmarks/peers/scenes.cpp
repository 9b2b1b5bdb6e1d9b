// SPDX-License-Identifier: Apache-2.0
#include "scenes.h"

#include <cmath>

#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/winding_number.h"
#include "pointbased/interpolation.h"

namespace peers {

using namespace pointbased;

namespace {

constexpr double kHeldPart = 0.2;  // of the organ's height

Surface boxSurface(const Vec3 &max) {
  Surface surface;
  for (int c = 0; c < 8; ++c)
    surface.positions.emplace_back(c & 1 ? max[0] : 0.0, c & 2 ? max[1] : 0.0, c & 4 ? max[2] : 0.0);
  surface.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return surface;
}

BodyShape barShape(const Vec3 &size) {
  BodyShape shape;
  shape.max = size;
  shape.volume = size.prod();
  shape.inside = [size](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i)
      inside[i] = (points[i].array() >= 0.0).all() && (points[i].array() <= size.array()).all() ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [size](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Array3d outside = (points[i] - 0.5 * size).array().abs() - 0.5 * size.array();
      distances[i] = std::abs(outside.max(0.0).matrix().norm() + std::min(outside.maxCoeff(), 0.0));
    }
  };
  shape.surface = boxSurface(size);
  return shape;
}

Vec3 meanOverFace(const Surface &surface, const RestState &rest, std::span<const Vec3> u, const Region &face) {
  const SurfacePoints points = sampleSurface(surface, 0.25 * rest.spacing, face);
  std::vector<Vec3> local;
  for (const Vec3 &x : points.positions) local.push_back(x - rest.origin);
  const Interpolation binding = rest.bind(local, points.normals);
  std::vector<Vec3> at(points.count());
  interpolateDisplacements(binding, rest.positions, u, at, serialFor());
  Vec3 sum = Vec3::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    sum += points.areas[i] * at[i];
    area += points.areas[i];
  }
  return sum / area;
}

/// ∫u dV over the free part, by the shape functions of the lattice.
Vec3 meanOfFreePart(const RestState &rest, std::span<const Vec3> u) {
  const std::vector<double> &all = rest.weightVolumes.empty() ? rest.volumes : rest.weightVolumes;
  Vec3 sum = Vec3::Zero();
  double volume = 0.0;
  for (std::size_t j = 0; j < u.size(); ++j) {
    const double v = all[j] - (rest.heldVolumes.empty() ? 0.0 : rest.heldVolumes[j]);
    sum += v * u[j];
    volume += v;
  }
  return sum / volume;
}

}  // namespace

Scene cantilever() {
  const Vec3 size(0.2, 0.04, 0.04);
  Scene scene;
  scene.name = "cantilever 0.2 x 0.04 x 0.04 m";
  scene.shape = barShape(size);
  scene.held = BoxRegion{Vec3(-1e-7, -1.0, -1.0), Vec3(1e-7, 1.0, 1.0)};
  scene.soft = {1e4, 0.3, 1000.0};
  scene.stiff = {1e6, 0.3, 1000.0};
  const auto layersFor = [](std::size_t nodes) {
    int layers = 1;
    while ((5 * layers + 1) * (layers + 1) * (layers + 1) < static_cast<int>(0.9 * static_cast<double>(nodes)))
      ++layers;
    return layers;
  };
  scene.mesh = [=](std::size_t nodes) { return meshBar(size, layersFor(nodes)); };
  scene.sampling = [=](std::size_t nodes) {
    LatticeSampling sampling;
    sampling.spacing = size[2] / layersFor(nodes);
    return sampling;
  };
  const Region end = BoxRegion{Vec3(size[0] - 1e-7, -1.0, -1.0), Vec3(size[0] + 1e-7, 1.0, 1.0)};
  scene.measure = [surface = scene.shape.surface, end](const RestState &rest, std::span<const Vec3> u) {
    return meanOverFace(surface, rest, u, end);
  };
  scene.truth = -0.0150087;
  scene.origin =
      "27-node hexahedra, neo-Hooke, limit of three meshes: tests/validation/truths, beam_sag_g0.0981 (the same "
      "problem with "
      "gravity and E divided by 100; corotated -15.0071 mm; Timoshenko's small deflection is -15.3 mm)";
  scene.size = size.maxCoeff();
  return scene;
}

Result<Scene> hangingOrgan(const std::filesystem::path &file) {
  auto loaded = c3de::geometry::loadMesh(file, c3de::geometry::LengthUnit::millimetre);
  if (!loaded) return tl::unexpected(loaded.error().message);
  c3de::geometry::TriangleMesh mesh = loaded->mesh;
  // About the origin: Bullet's positions are single precision.
  const c3de::geometry::Box &box = loaded->report.box;
  const double toMetres = 1e-3;
  for (c3de::Vec3 &x : mesh.vertices)
    for (std::size_t k = 0; k < 3; ++k) x[k] = toMetres * (x[k] - 0.5 * (box.min[k] + box.max[k]));
  auto tree = c3de::collision::AabbTree::build(mesh.vertices, mesh.triangles);
  if (!tree) return tl::unexpected(tree.error().message);
  const auto surface = std::make_shared<const c3de::collision::AabbTree>(std::move(*tree));
  const auto winding = std::make_shared<const c3de::geometry::WindingNumber>(mesh);
  const auto at = [](const Vec3 &x) { return c3de::Vec3{x[0], x[1], x[2]}; };

  Scene scene;
  scene.name = "organ " + file.filename().string() + ", hanging from its uppermost fifth";
  BodyShape &shape = scene.shape;
  for (std::size_t k = 0; k < 3; ++k)
    shape.max[static_cast<Eigen::Index>(k)] = 0.5 * toMetres * (box.max[k] - box.min[k]);
  shape.min = -shape.max;
  shape.volume = std::abs(c3de::geometry::signedVolume(mesh));
  shape.inside = [=](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = winding->at(at(points[i]));
  };
  shape.surfaceDistance = [=](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(surface->closest(at(points[i])).distance);
  };
  shape.crosses = [=](std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses) {
    for (std::size_t i = 0; i < from.size(); ++i) crosses[i] = surface->segment(at(from[i]), at(to[i])).isHit() ? 1 : 0;
  };
  for (const c3de::Vec3 &x : mesh.vertices) shape.surface.positions.emplace_back(x[0], x[1], x[2]);
  for (const c3de::Triangle &t : mesh.triangles) shape.surface.triangles.push_back({t[0], t[1], t[2]});

  const double heldFrom = shape.max[2] - kHeldPart * (shape.max[2] - shape.min[2]);
  scene.held = HalfSpaceRegion{Vec3(0.0, 0.0, heldFrom), -Vec3::UnitZ()};
  scene.soft = {6e3, 0.45, 1060.0};
  scene.stiff = {6e5, 0.45, 1060.0};
  const auto closest = [=](const Vec3 &x) {
    const c3de::Vec3 p = surface->closest(at(x)).point;
    return Vec3(p[0], p[1], p[2]);
  };
  scene.mesh = [shape, closest, heldFrom](std::size_t nodes) { return meshOrgan(shape, closest, heldFrom, nodes); };
  scene.sampling = [](std::size_t nodes) {
    LatticeSampling sampling;
    sampling.count = nodes;
    return sampling;
  };
  scene.measure = [](const RestState &rest, std::span<const Vec3> u) { return meanOfFreePart(rest, u); };
  scene.size = (shape.max - shape.min).maxCoeff();
  return scene;
}

}  // namespace peers
