// SPDX-License-Identifier: Apache-2.0
#include "brute_force.h"
#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/winding_number.h"
#include "support/catch.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using collision::AabbTree;

namespace {

/// Signed distance to an axis-aligned box, exact.
double boxDistance(const Vec3 &p, const Vec3 &min, const Vec3 &max) {
  Vec3 outside{};
  double inside = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max(min[k] - p[k], p[k] - max[k]);
    outside[k] = std::max(d, 0.0);
    inside = std::max(inside, d);
  }
  return inside > 0.0 ? norm(outside) : inside;
}

}  // namespace

TEST_CASE("Signed distances to a box are exact, at its edges and corners too") {
  const Vec3 min{-1, -2, -3}, max{4, 5, 6};
  const auto mesh = shapes::box(min, max);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  REQUIRE(tree->isClosed());
  shapes::RandomPoints random(31);
  for (int i = 0; i < 5000; ++i) {
    Vec3 p = random.in({-4, -5, -6}, {7, 8, 9});
    if (i % 5 == 0) p = {std::round(p[0]), std::round(p[1]), std::round(p[2])};  // many of these are in face planes
    const collision::ClosestPoint c = tree->closest(p);
    REQUIRE_THAT(c.distance, WithinAbs(boxDistance(p, min, max), 1e-12));
    REQUIRE_THAT(norm(c.normal), WithinAbs(1.0, 1e-12));
    REQUIRE_THAT(norm(p - c.point), WithinAbs(std::abs(c.distance), 1e-12));
  }
}

TEST_CASE("Signed distances to a fine sphere agree with the formula up to the facets") {
  const double radius = 10.0;
  const auto mesh = shapes::sphere({0, 0, 0}, radius, 4);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  // Depth of the largest facet below the sphere: half an edge squared over the diameter, times 4/3 for its centre.
  double longest = 0.0;
  for (const Triangle &t : mesh.triangles) longest = std::max(longest, norm(mesh.vertices[t[1]] - mesh.vertices[t[0]]));
  const double sagitta = longest * longest / (3.0 * 2.0 * radius) * 1.1;
  shapes::RandomPoints random(32);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = random.in({-15, -15, -15}, {15, 15, 15});
    const collision::ClosestPoint c = tree->closest(p);
    const double expected = norm(p) - radius;
    REQUIRE(c.distance >= expected - 1e-9);
    REQUIRE(c.distance <= expected + sagitta);
    if (std::abs(expected) > 1.0 && norm(p) > 3.0) REQUIRE(dot(c.normal, (1.0 / norm(p)) * p) > 0.99);
  }
}

TEST_CASE("Distances agree with brute force on organs and their sign with the winding number") {
  for (const char *file :
       {"mesh/openhelp/Pancreas.stl", "mesh/ssvtk_liver_patient/portal_vein.vtk", "mesh/sofa/liver.obj"}) {
    C3DE_DATA_OR_SKIP(path, file);
    INFO(file);
    const auto loaded = geometry::loadMesh(path, geometry::LengthUnit::millimetre);
    REQUIRE(loaded);
    const auto &mesh = loaded->mesh;
    const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
    REQUIRE(tree);
    REQUIRE(tree->isClosed());
    const geometry::WindingNumber winding(mesh);
    const auto [min, max] = loaded->report.box;
    shapes::RandomPoints random(33);
    int inside = 0;
    for (int i = 0; i < 1000; ++i) {
      Vec3 p = random.in(min, max);
      if (i % 4 == 0) {  // next to a corner, an edge or a face
        const Triangle &t = mesh.triangles[random.index(mesh.triangles.size())];
        const double s = i % 8 == 0 ? 0.0 : random.uniform(0.0, 1.0);
        p = (1.0 - s) * mesh.vertices[t[0]] + s * mesh.vertices[t[1]] +
            random.in({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01});
      }
      const collision::ClosestPoint c = tree->closest(p);
      if (i < 300) REQUIRE_THAT(std::abs(c.distance), WithinAbs(brute_force::distance(mesh, p), 1e-9));
      const double w = winding.at(p);
      inside += w > 0.5;
      if (std::abs(c.distance) > 1e-9) REQUIRE((c.distance < 0.0) == (w > 0.5));
    }
    CHECK(inside > 50);
  }
}

TEST_CASE("Nothing is found beyond the greatest distance, and something at it") {
  const auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  CHECK_FALSE(tree->closest({0.5, 0.5, 3.0}, 1.99).isFound());
  CHECK(tree->closest({0.5, 0.5, 3.0}, 2.0).isFound());
  CHECK_FALSE(tree->closest({0.5, 0.5, 3.0}, -1.0).isFound());
  CHECK_FALSE(tree->closest({0.5, std::nan(""), 3.0}).isFound());
}

TEST_CASE("Distances to an open surface have no sign") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  CHECK_FALSE(tree->isClosed());
  CHECK_THAT(tree->closest({0.5, 0.5, 0.9}).distance, WithinAbs(0.1, 1e-12));
}

TEST_CASE("The sign is right at a sharp edge, where the nearest faces alone would mislead") {
  // A thin wedge: points just beyond the sharp edge are behind the plane of one of its two faces.
  const geometry::TriangleMesh wedge{
      {{0, 0, 0}, {0, 10, 0}, {10, 0, 0.2}, {10, 10, 0.2}, {10, 0, -0.2}, {10, 10, -0.2}},
      {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}, {2, 4, 3}, {3, 4, 5}, {0, 4, 2}, {1, 3, 5}}};
  auto mesh = wedge;
  if (geometry::signedVolume(mesh) < 0.0) shapes::turnInsideOut(mesh);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  REQUIRE(tree->isClosed());
  shapes::RandomPoints random(34);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = random.in({-1, 1, -1}, {-1e-6, 9, 1});
    REQUIRE(tree->closest(p).distance > 0.0);
    const double x = random.uniform(0.1, 9.9);
    REQUIRE(tree->closest({x, random.uniform(1, 9), random.uniform(-0.019, 0.019) * x}).distance < 0.0);
  }
}
