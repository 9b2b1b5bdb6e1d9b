// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using namespace c3de::geometry;
using test_files::contains;

namespace {

LoadedMesh built(TriangleMesh raw) {
  auto loaded = buildMesh(std::move(raw), LengthUnit::millimetre);
  if (!loaded) FAIL(loaded.error().message);
  return *loaded;
}

std::string refusal(TriangleMesh raw, LengthUnit unit = LengthUnit::millimetre) {
  const auto loaded = buildMesh(std::move(raw), unit);
  return loaded ? "was accepted" : loaded.error().message;
}

}  // namespace

TEST_CASE("A clean mesh is left as it is") {
  const auto sphere = shapes::sphere({5, 6, 7}, 10.0, 2);
  const auto loaded = built(sphere);
  CHECK(loaded.mesh.vertices == sphere.vertices);
  CHECK(loaded.mesh.triangles == sphere.triangles);
  CHECK(loaded.report.repairs.empty());
  CHECK(loaded.report.warnings.empty());
}

TEST_CASE("A soup of triangles is welded to a closed surface, exactly and within rounding") {
  const auto sphere = shapes::sphere({50, 60, 70}, 10.0, 2);
  for (double noise : {0.0, 1e-10}) {
    shapes::RandomPoints random(1);
    TriangleMesh soup;
    for (const Triangle &t : sphere.triangles) {
      const auto n = static_cast<unsigned>(soup.vertices.size());
      soup.triangles.push_back({n, n + 1, n + 2});
      for (unsigned v : t)
        soup.vertices.push_back(sphere.vertices[v] + random.in({-noise, -noise, -noise}, {noise, noise, noise}));
    }
    const auto loaded = built(soup);
    CHECK(loaded.report.vertices == sphere.vertices.size());
    CHECK(loaded.report.closed);
    CHECK(contains(loaded.report.repairs, "welded"));
  }
}

TEST_CASE("Small parts that are farther apart than rounding are not welded") {
  auto two = shapes::box({0, 0, 0}, {1, 1, 1});
  shapes::append(two, shapes::box({1.00001, 0, 0}, {2, 1, 1}));
  CHECK(built(two).report.components == 2);
}

TEST_CASE("Triangles that name a corner twice and unused vertices are dropped") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 1);
  const std::size_t triangles = mesh.triangles.size(), vertices = mesh.vertices.size();
  mesh.triangles.insert(mesh.triangles.begin() + 3, {{1, 1, 2}, {5, 5, 5}});
  mesh.vertices.push_back({1e6, 0, 0});
  const auto loaded = built(mesh);
  CHECK(loaded.report.triangles == triangles);
  CHECK(loaded.report.vertices == vertices);
  CHECK(loaded.report.closed);
  CHECK(contains(loaded.report.repairs, "2 triangles that name a corner twice"));
  CHECK(contains(loaded.report.repairs, "1 vertex that no triangle uses"));
}

TEST_CASE("A triangle with three corners on a line is removed without tearing the surface") {
  // The side from (0,0,0) to (10,0,0) of a box is cut by a vertex on one of its two triangles only; a triangle without
  // area closes the seam, as exporters write it.
  auto mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  mesh.vertices.push_back({4, 0, 0});
  REQUIRE(mesh.triangles[0] == Triangle{0, 2, 1});
  mesh.triangles[0] = {0, 2, 8};
  mesh.triangles.push_back({8, 2, 1});
  mesh.triangles.push_back({0, 8, 1});
  REQUIRE(inspect(mesh, LengthUnit::millimetre).degenerateTriangles == 1);
  const auto loaded = built(mesh);
  CHECK(loaded.report.degenerateTriangles == 0);
  CHECK(loaded.report.closed);
  CHECK(loaded.report.oriented);
  CHECK_THAT(loaded.report.volume_mm3, WithinRel(1000.0, 1e-12));
  CHECK_THAT(loaded.report.area_mm2, WithinRel(600.0, 1e-12));
  CHECK(contains(loaded.report.repairs, "three corners on a line"));
}

TEST_CASE("Copies of triangles are dropped, one of each stays") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.push_back({2, 1, 0});  // the first one, starting at another corner
  mesh.triangles.push_back(mesh.triangles[5]);
  const auto loaded = built(mesh);
  CHECK(loaded.report.triangles == 12);
  CHECK(loaded.report.closed);
  CHECK(contains(loaded.report.repairs, "2 copies"));
}

TEST_CASE("Two triangles back to back bound nothing and go together") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.push_back({2, 0, 0});
  mesh.triangles.push_back({1, 3, 8});
  mesh.triangles.push_back({3, 1, 8});  // a fin
  const auto loaded = built(mesh);
  CHECK(loaded.report.triangles == 12);
  CHECK(loaded.report.manifold);
  CHECK(contains(loaded.report.repairs, "2 coincident triangles"));
}

TEST_CASE("A surface whose every triangle comes with its back side keeps one of them") {
  auto mesh = shapes::sphere({0, 0, 0}, 1.0, 2);
  auto back = mesh;
  shapes::turnInsideOut(back);
  mesh.triangles.insert(mesh.triangles.end(), back.triangles.begin(), back.triangles.end());
  const auto loaded = built(mesh);
  CHECK(loaded.report.triangles == back.triangles.size());
  CHECK(loaded.report.closed);
  CHECK(loaded.report.volume_mm3 > 3.5);
  CHECK(checkFillable(loaded.mesh, loaded.report));
}

TEST_CASE("An inside-out surface is turned and the report says so") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 2);
  shapes::turnInsideOut(mesh);
  const auto before = inspect(mesh, LengthUnit::millimetre);
  CHECK(before.insideOut);
  CHECK(before.volume_mm3 < 0.0);
  CHECK_FALSE(checkFillable(mesh, before));
  const auto loaded = built(mesh);
  CHECK_FALSE(loaded.report.insideOut);
  CHECK(loaded.report.volume_mm3 > 0.0);
  CHECK(contains(loaded.report.repairs, "inside out"));
}

TEST_CASE("Triangles that face the other way than their neighbours are turned") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 3);
  const double volume = signedVolume(mesh);
  shapes::RandomPoints random(2);
  std::size_t turned = 0;
  for (Triangle &t : mesh.triangles)
    if (random.uniform(0, 1) < 0.3) {
      std::swap(t[1], t[2]);
      ++turned;
    }
  CHECK(inspect(mesh, LengthUnit::millimetre).misorientedEdges > turned);
  const auto loaded = built(mesh);
  CHECK(loaded.report.oriented);
  CHECK_THAT(loaded.report.volume_mm3, WithinRel(volume, 1e-12));
  CHECK(contains(loaded.report.repairs, std::to_string(turned) + " triangles oriented opposite to"));
}

TEST_CASE("A cavity stays a cavity, also when the whole file is inside out") {
  const double outer = signedVolume(shapes::sphere({0, 0, 0}, 10.0, 2)),
               inner = signedVolume(shapes::sphere({1, 0, 0}, 4.0, 2));
  for (bool isInsideOut : {false, true}) {
    auto mesh = shapes::sphere({0, 0, 0}, 10.0, 2), cavity = shapes::sphere({1, 0, 0}, 4.0, 2);
    shapes::turnInsideOut(cavity);
    shapes::append(mesh, cavity);
    if (isInsideOut) shapes::turnInsideOut(mesh);
    const auto loaded = built(mesh);
    CHECK_THAT(loaded.report.volume_mm3, WithinRel(outer - inner, 1e-9));
    CHECK(loaded.report.repairs.empty() == !isInsideOut);
  }
}

TEST_CASE("Of separate parts only those inside out are turned") {
  TriangleMesh mesh;
  for (int i = 0; i < 10; ++i) {
    auto part = shapes::sphere({30.0 * i, 0, 0}, 10.0, 1);
    if (i % 3 == 0) shapes::turnInsideOut(part);
    shapes::append(mesh, part);
  }
  const auto loaded = built(mesh);
  CHECK(loaded.report.components == 10);
  CHECK_THAT(loaded.report.volume_mm3, WithinRel(10.0 * signedVolume(shapes::sphere({0, 0, 0}, 10.0, 1)), 1e-9));
  CHECK(contains(loaded.report.repairs, "4 of 10 parts"));
  CHECK(contains(loaded.report.warnings, "10 separate parts"));
  CHECK(checkFillable(loaded.mesh, loaded.report));
}

TEST_CASE("A Moebius strip is left as found") {
  TriangleMesh mesh;
  constexpr unsigned n = 24;
  for (unsigned i = 0; i < n; ++i)
    for (double side : {-1.0, 1.0}) {
      const double a = 2.0 * std::numbers::pi * i / n;
      const double r = 5.0 + side * std::cos(a / 2.0);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), side * std::sin(a / 2.0)});
    }
  for (unsigned i = 0; i < n; ++i) {
    const unsigned a = 2 * i, b = a + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
  }
  const auto loaded = built(mesh);
  CHECK(loaded.report.triangles == 2 * n);
  CHECK_FALSE(loaded.report.oriented);
  CHECK(contains(loaded.report.repairs, "Moebius"));
  CHECK_FALSE(checkFillable(loaded.mesh, loaded.report));
}

TEST_CASE("Meshes that cannot be cleaned are refused with what was found") {
  const auto box = shapes::box({0, 0, 0}, {1, 1, 1});
  auto mesh = box;
  mesh.triangles.clear();
  CHECK_THAT(refusal(mesh), Contains("no faces"));
  mesh = box;
  mesh.triangles[4][1] = 8;
  CHECK_THAT(refusal(mesh), Contains("triangle 4") && Contains("index 8") && Contains("0 to 7"));
  mesh = box;
  mesh.vertices[2][1] = std::nan("");
  CHECK_THAT(refusal(mesh), Contains("y coordinate nan of vertex 2"));
  mesh = box;
  mesh.vertices[2][1] = 1e300;
  CHECK_THAT(refusal(mesh), Contains("1e+300") && Contains("1e9 mm"));
  mesh = box;
  mesh.triangles.resize(3);
  CHECK_THAT(refusal(mesh), Contains("3 triangles") && Contains("at least 4"));
  mesh = box;
  for (Vec3 &v : mesh.vertices) v = {1, 2, 3};
  CHECK_THAT(refusal(mesh), Contains("0 triangles") && Contains("12 triangles that name a corner twice"));
}

TEST_CASE("A flat closed surface is kept but cannot be filled") {
  auto mesh = shapes::sphere({0, 0, 0}, 10.0, 3);
  for (Vec3 &v : mesh.vertices) v[2] *= 1e-10;
  const auto loaded = buildMesh(mesh, LengthUnit::millimetre);
  if (!loaded) return;  // welding may leave an empty mesh, which is also a refusal
  const auto fill = checkFillable(loaded->mesh, loaded->report);
  REQUIRE_FALSE(fill);
  CHECK_THAT(fill.error().message, Contains("flat") || Contains("open"));
}
