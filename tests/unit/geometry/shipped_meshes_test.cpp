// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_io.h"
#include "c3de/geometry/winding_number.h"
#include "support/catch.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using namespace c3de::geometry;

namespace {

LoadedMesh shipped(const char *name) {
  auto loaded = loadMesh(std::filesystem::path(testResourcesFolder()) / "meshes" / name, LengthUnit::millimetre);
  if (!loaded) FAIL(loaded.error().message);
  return *loaded;
}

void checkFlawless(const LoadedMesh &loaded) {
  CHECK(loaded.report.closed);
  CHECK(loaded.report.manifold);
  CHECK(loaded.report.oriented);
  CHECK(loaded.report.components == 1);
  CHECK(loaded.report.repairs.empty());
  CHECK(loaded.report.warnings.empty());
  CHECK(checkFillable(loaded.mesh, loaded.report));
  // Euler characteristic 2: no handles.
  CHECK(loaded.report.vertices + loaded.report.triangles == 3 * loaded.report.triangles / 2 + 2);
  double worst = 1.0;
  for (const Triangle &t : loaded.mesh.triangles) {
    const Vec3 a = loaded.mesh.vertices[t[0]], b = loaded.mesh.vertices[t[1]], c = loaded.mesh.vertices[t[2]];
    const double x = norm(b - a), y = norm(c - b), z = norm(a - c), area2 = norm(cross(b - a, c - a));
    worst = std::min(worst, 4.0 * area2 * area2 / ((x + y + z) * x * y * z));
  }
  CHECK(worst > 0.4);  // 1 is equilateral
}

/// Volume of the convex hull from outside: the cut of half spaces in many directions. Above the hull's volume by less
/// than one percent for a smooth body.
double hullVolume(const TriangleMesh &mesh, const Box &box) {
  struct HalfSpace {
    Vec3 normal;
    double offset;
  };
  std::vector<HalfSpace> halfSpaces;
  constexpr int kDirections = 1500;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kDirections, a = 2.399963229728653 * i, r = std::sqrt(1.0 - z * z);
    HalfSpace h{{r * std::cos(a), r * std::sin(a), z}, -1e300};
    for (const Vec3 &v : mesh.vertices) h.offset = std::max(h.offset, dot(h.normal, v));
    halfSpaces.push_back(h);
  }
  constexpr int n = 40;
  const Vec3 size = box.max - box.min;
  int inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 p{box.min[0] + size[0] * (i + 0.5) / n, box.min[1] + size[1] * (j + 0.5) / n,
                     box.min[2] + size[2] * (k + 0.5) / n};
        bool isInside = true;
        for (const HalfSpace &h : halfSpaces)
          if (dot(h.normal, p) > h.offset) {
            isInside = false;
            break;
          }
        inside += isInside;
      }
  return inside * size[0] * size[1] * size[2] / (n * n * n);
}

}  // namespace

TEST_CASE("The shipped organ is a flawless closed surface of a plausible size") {
  const auto organ = shipped("organ.obj");
  checkFlawless(organ);
  CHECK(organ.report.triangles >= 2000);
  CHECK(organ.report.triangles <= 6000);
  CHECK_THAT(organ.report.box.max[0] - organ.report.box.min[0], WithinAbs(200.0, 20.0));
  CHECK(organ.report.volume_mm3 > 0.8e6);  // livers of adults: 0.8 to 1.8 litres
  CHECK(organ.report.volume_mm3 < 1.8e6);
}

TEST_CASE("The shipped organ is hollow on its underside") {
  const auto organ = shipped("organ.obj");
  const double hull = hullVolume(organ.mesh, organ.report.box);
  const auto convex = shapes::sphere({0, 0, 0}, 50.0, 3);
  // the measure itself
  CHECK_THAT(signedVolume(convex) / hullVolume(convex, boundingBox(convex)), WithinAbs(1.0, 0.02));
  CHECK(organ.report.volume_mm3 < 0.88 * hull);
}

TEST_CASE("The shipped obstacle is a flawless block of its size") {
  const auto block = shipped("obstacle_block.obj");
  checkFlawless(block);
  CHECK_THAT(block.report.box.max[0] - block.report.box.min[0], WithinAbs(160.0, 0.5));
  CHECK_THAT(block.report.box.max[1] - block.report.box.min[1], WithinAbs(60.0, 0.5));
  CHECK_THAT(block.report.box.max[2] - block.report.box.min[2], WithinAbs(120.0, 0.5));
}
