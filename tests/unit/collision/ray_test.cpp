// SPDX-License-Identifier: Apache-2.0
#include "brute_force.h"
#include "c3de/collision/aabb_tree.h"
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using collision::AabbTree;

namespace {

/// Hits and misses agree with brute force; t within rounding. A ray that grazes an edge may differ in the last bits, so
/// a difference counts only if brute force finds it for slightly moved rays too.
void compareWithBruteForce(const geometry::TriangleMesh &mesh, unsigned seed, int rays) {
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  const geometry::Box box = geometry::boundingBox(mesh);
  const Vec3 size = box.max - box.min;
  shapes::RandomPoints random(seed);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Vec3 origin = random.in(box.min - 0.5 * size, box.max + 0.5 * size);
    const Vec3 direction = random.in(box.min, box.max) - origin;
    const double expected = brute_force::rayT(mesh, origin, direction);
    const collision::RayHit hit = tree->ray(origin, direction);
    REQUIRE(hit.isHit() == std::isfinite(expected));
    if (!hit.isHit()) continue;
    ++hits;
    REQUIRE_THAT(hit.t, WithinAbs(expected, 1e-9));
    const Triangle &t = mesh.triangles[hit.triangle];
    const Vec3 at =
        hit.bary[0] * mesh.vertices[t[0]] + hit.bary[1] * mesh.vertices[t[1]] + hit.bary[2] * mesh.vertices[t[2]];
    REQUIRE(norm(at - (origin + hit.t * direction)) < 1e-9 * norm(size));
  }
  CHECK(hits > rays / 10);
}

}  // namespace

TEST_CASE("Rays agree with brute force on a sphere") {
  compareWithBruteForce(shapes::sphere({1, -2, 3}, 5.0, 3), 11, 2000);
}

TEST_CASE("Rays agree with brute force on organs") {
  for (const char *file :
       {"mesh/openhelp/Pancreas.stl", "mesh/sofa_env_nasty/grasp/liver_collision.stl", "mesh/sofa/n0.obj"}) {
    C3DE_DATA_OR_SKIP(path, file);
    INFO(file);
    const auto loaded = geometry::loadMesh(path, geometry::LengthUnit::millimetre);
    REQUIRE(loaded);
    compareWithBruteForce(loaded->mesh, 12, 400);
  }
}

TEST_CASE("A ray into a closed surface never slips through an edge or a corner") {
  const auto mesh = shapes::sphere({0.1, 0.2, 0.3}, 1.0, 3);
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  shapes::RandomPoints random(21);
  int missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const Triangle &t = mesh.triangles[random.index(mesh.triangles.size())];
    const double s = i % 3 == 0 ? 0.0 : random.uniform(0.0, 1.0);  // a third of the rays aim at corners
    const Vec3 target = (1.0 - s) * mesh.vertices[t[0]] + s * mesh.vertices[t[1]];
    const Vec3 inside = random.in({-0.3, -0.2, -0.1}, {0.5, 0.6, 0.7});
    missed += !tree->ray(inside, target - inside).isHit();
  }
  CHECK(missed == 0);
}

TEST_CASE("Rays in the planes and along the edges of an axis-aligned box are answered") {
  const auto mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  CHECK_THAT(tree->ray({5, 5, -5}, {0, 0, 1}).t, WithinAbs(5.0, 1e-12));  // through the diagonal of two faces
  CHECK_THAT(tree->ray({0, 0, -5}, {0, 0, 1}).t, WithinAbs(5.0, 1e-12));  // onto a corner, along an edge
  CHECK_THAT(tree->ray({0, 5, -5}, {0, 0, 1}).t, WithinAbs(5.0, 1e-12));  // in the plane of a face
  CHECK_FALSE(tree->ray({11, 5, -5}, {0, 0, 1}).isHit());
  CHECK_FALSE(tree->ray({5, 5, -5}, {0, 0, -1}).isHit());
  CHECK_THAT(tree->ray({5, 5, 5}, {0, 0, 2}).t, WithinAbs(2.5, 1e-12));  // from inside; t counts directions, not mm
}

TEST_CASE("A ray ends at its greatest t and a segment at its ends") {
  const auto mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  const auto tree = AabbTree::build(mesh.vertices, mesh.triangles);
  REQUIRE(tree);
  CHECK_FALSE(tree->ray({4, 5, -5}, {0, 0, 1}, 4.999).isHit());
  CHECK(tree->ray({4, 5, -5}, {0, 0, 1}, 5.001).isHit());
  CHECK_FALSE(tree->segment({4, 5, -5}, {4, 5, -0.01}).isHit());
  CHECK_THAT(tree->segment({4, 5, -5}, {4, 5, 5}).t, WithinAbs(0.5, 1e-12));
  CHECK_THAT(tree->segment({4.1, 5.3, -5.7}, {4.1, 5.3, 0.0}).t, WithinAbs(1.0, 1e-9));  // ends on the surface
  CHECK_FALSE(tree->segment({4, 5, -5}, {4, 5, -5}).isHit());
  CHECK_FALSE(tree->ray({4, 5, std::nan("")}, {0, 0, 1}).isHit());
}
