// SPDX-License-Identifier: Apache-2.0
#include "scenes.h"

#include <cmath>

#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "mesh_body.h"
#include "pointbased/interpolation.h"
#include "shapes.h"
#include "surfaces.h"

namespace peers {

using namespace pointbased;

namespace {

constexpr double kHeldPart = 0.2;  // of the organ's height

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
  scene.shape = shapes::box(Vec3::Zero(), size);
  scene.shape.surface = shapes::boxSurface(Vec3::Zero(), size);
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
  // About the origin: Bullet's positions are single precision.
  const c3de::geometry::Box &box = loaded->report.box;
  std::vector<c3de::Vec3> vertices = loaded->mesh.vertices;
  Surface skin;
  for (c3de::Vec3 &x : vertices) {
    for (std::size_t k = 0; k < 3; ++k) x[k] = 1e-3 * (x[k] - 0.5 * (box.min[k] + box.max[k]));
    skin.positions.emplace_back(x[0], x[1], x[2]);
  }
  for (const c3de::Triangle &t : loaded->mesh.triangles) skin.triangles.push_back({t[0], t[1], t[2]});
  auto tree = c3de::collision::AabbTree::build(vertices, loaded->mesh.triangles);
  if (!tree) return tl::unexpected(tree.error().message);
  const auto surface = std::make_shared<const c3de::collision::AabbTree>(std::move(*tree));

  Scene scene;
  scene.name = "organ " + file.filename().string() + ", hanging from its uppermost fifth";
  scene.shape = validation::meshShape(skin);
  const BodyShape &shape = scene.shape;
  const double heldFrom = shape.max[2] - kHeldPart * (shape.max[2] - shape.min[2]);
  scene.held = HalfSpaceRegion{Vec3(0.0, 0.0, heldFrom), -Vec3::UnitZ()};
  scene.soft = {6e3, 0.45, 1060.0};
  scene.stiff = {6e5, 0.45, 1060.0};
  const auto closest = [=](const Vec3 &x) {
    const c3de::Vec3 p = surface->closest({x[0], x[1], x[2]}).point;
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
