// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/mesh_io.h"
#include "support/catch.h"
#include "test_files.h"
#include "unit/geometry/shapes.h"

using namespace c3de;
using namespace c3de::geometry;
using test_files::contains;

namespace {

std::string whyNot(const TriangleMesh &mesh, LengthUnit unit = LengthUnit::millimetre) {
  const auto fill = checkFillable(mesh, inspect(mesh, unit));
  return fill ? "can be filled" : fill.error().message;
}

/// The part of a sphere below a height, open at the top.
TriangleMesh cutSphere(double radius, double height) {
  auto mesh = shapes::sphere({0, 0, 0}, radius, 4);
  std::erase_if(mesh.triangles, [&](const Triangle &t) {
    return mesh.vertices[t[0]][2] > height && mesh.vertices[t[1]][2] > height && mesh.vertices[t[2]][2] > height;
  });
  auto loaded = buildMesh(mesh, LengthUnit::millimetre);
  REQUIRE(loaded);
  return loaded->mesh;
}

}  // namespace

TEST_CASE("Volume, area, box and counts of a box are exact") {
  const auto report = inspect(shapes::box({-1, -2, -3}, {4, 5, 6}), LengthUnit::millimetre);
  CHECK(report.vertices == 8);
  CHECK(report.triangles == 12);
  CHECK(report.components == 1);
  CHECK(report.closed);
  CHECK(report.manifold);
  CHECK(report.oriented);
  CHECK_FALSE(report.insideOut);
  CHECK_THAT(report.volume_mm3, WithinRel(5.0 * 7.0 * 9.0, 1e-14));
  CHECK_THAT(report.area_mm2, WithinRel(2.0 * (35 + 63 + 45), 1e-14));
  CHECK(report.box.min == Vec3{-1, -2, -3});
  CHECK(report.box.max == Vec3{4, 5, 6});
}

TEST_CASE("The volume does not depend on where the mesh lies") {
  CHECK_THAT(signedVolume(shapes::sphere({1e6, -1e6, 1e6}, 1.0, 3)),
             WithinRel(signedVolume(shapes::sphere({0, 0, 0}, 1.0, 3)), 1e-8));
}

TEST_CASE("A vertex normal of a sphere points away from its centre") {
  const auto mesh = shapes::sphere({1, 2, 3}, 5.0, 3);
  const auto normals = vertexNormals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    REQUIRE_THAT(norm(normals[v]), WithinAbs(1.0, 1e-12));
    REQUIRE(dot(normals[v], 0.2 * (mesh.vertices[v] - Vec3{1, 2, 3})) > 0.99);
  }
}

TEST_CASE("Boundary, non-manifold and misoriented edges are counted") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.erase(mesh.triangles.begin());
  auto report = inspect(mesh, LengthUnit::millimetre);
  CHECK(report.boundaryEdges == 3);
  CHECK_FALSE(report.closed);
  CHECK(contains(report.warnings, "3 boundary edges in 1 place"));

  mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.push_back({2, 2, 0});
  mesh.triangles.push_back({1, 3, 8});
  report = inspect(mesh, LengthUnit::millimetre);
  CHECK(report.nonManifoldEdges == 1);
  CHECK(report.boundaryEdges == 2);
  CHECK_FALSE(report.manifold);
  CHECK(contains(report.warnings, "non-manifold"));

  mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  report = inspect(mesh, LengthUnit::millimetre);
  CHECK(report.misorientedEdges == 3);
  CHECK_FALSE(report.oriented);
}

TEST_CASE("Vertices at equal positions count as one for edges and parts") {
  const auto box = shapes::box({0, 0, 0}, {1, 1, 1});
  TriangleMesh soup;
  for (const Triangle &t : box.triangles) {
    const auto n = static_cast<unsigned>(soup.vertices.size());
    for (unsigned v : t) soup.vertices.push_back(box.vertices[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  const auto report = inspect(soup, LengthUnit::millimetre);
  CHECK(report.vertices == 36);
  CHECK(report.components == 1);
  CHECK(report.closed);
}

TEST_CASE("Inspecting a hopeless mesh says so instead of failing") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.vertices[0][0] = std::nan("");
  CHECK(contains(inspect(mesh, LengthUnit::millimetre).warnings, "not finite"));
  mesh.vertices.resize(3);
  CHECK(contains(inspect(mesh, LengthUnit::millimetre).warnings, "do not exist"));
  CHECK(contains(inspect({}, LengthUnit::millimetre).warnings, "no triangles"));
  CHECK_FALSE(checkFillable({}, inspect({}, LengthUnit::millimetre)));
}

TEST_CASE("Millimetres taken for metres are refused with the hint about the unit") {
  const auto liver = buildMesh(shapes::sphere({0, 0, 0}, 100.0, 3), LengthUnit::metre);
  REQUIRE(liver);
  CHECK(contains(liver->report.warnings, "larger than a person"));
  const auto fill = checkFillable(liver->mesh, liver->report);
  REQUIRE_FALSE(fill);
  CHECK_THAT(fill.error().message, Contains("346.4 m") && Contains("10 m") && Contains("mesh_unit"));
}

TEST_CASE("A mesh of a few metres is filled with a warning, one below a millimetre too") {
  const auto large = buildMesh(shapes::sphere({0, 0, 0}, 2.5, 3), LengthUnit::metre);
  REQUIRE(large);
  CHECK(contains(large->report.warnings, "larger than a person"));
  CHECK(checkFillable(large->mesh, large->report));
  const auto small = buildMesh(shapes::sphere({0, 0, 0}, 0.1, 3), LengthUnit::millimetre);
  REQUIRE(small);
  CHECK(contains(small->report.warnings, "smaller than any organ"));
  CHECK(checkFillable(small->mesh, small->report));
}

TEST_CASE("A small hole can be filled over, an open surface cannot") {
  CHECK_THAT(whyNot(cutSphere(50.0, 48.0)), Contains("can be filled"));
  CHECK(contains(inspect(cutSphere(50.0, 48.0), LengthUnit::millimetre).warnings, "not closed"));
  CHECK_THAT(whyNot(cutSphere(50.0, 25.0)), Contains("open"));
  CHECK_THAT(whyNot(cutSphere(50.0, 0.0)),
             Contains("open") && Contains("60 boundary edges") && Contains("5 % is accepted"));
  TriangleMesh plane;
  for (unsigned i = 0; i < 5; ++i)
    for (unsigned j = 0; j < 5; ++j) {
      plane.vertices.push_back({10.0 * i, 10.0 * j, 3.0});
      const unsigned v = 5 * i + j;
      if (i < 4 && j < 4) plane.triangles.insert(plane.triangles.end(), {{v, v + 5, v + 6}, {v, v + 6, v + 1}});
    }
  CHECK_THAT(whyNot(plane), Contains("flat"));
}

TEST_CASE("A surface without volume cannot be filled") {
  auto mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  for (Vec3 &v : mesh.vertices) v[2] = 5.0;
  CHECK_THAT(whyNot(mesh), Contains("flat"));
}

TEST_CASE("Two boxes with a common edge can be filled although four triangles meet there") {
  auto mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  shapes::append(mesh, shapes::box({1, 1, 0}, {2, 2, 1}));
  const auto loaded = buildMesh(mesh, LengthUnit::millimetre);
  REQUIRE(loaded);
  CHECK(loaded->report.nonManifoldEdges == 1);
  CHECK(loaded->report.components == 1);
  CHECK(checkFillable(loaded->mesh, loaded->report));
}

TEST_CASE("The text names units and the JSON holds every field") {
  auto mesh = shapes::sphere({0, 0, 0}, 50.0, 3);
  shapes::turnInsideOut(mesh);
  const auto loaded = buildMesh(mesh, LengthUnit::millimetre);
  REQUIRE(loaded);
  const std::string text = loaded->report.text();
  CHECK_THAT(text, Contains("100 x 100 x 100 mm") && Contains("cm³") && Contains("closed       yes") &&
                       Contains("repaired: ") && Contains("cm²"));
  const std::string json = loaded->report.json();
  for (const char *key : {"vertices", "triangles", "components", "boundary_edges", "non_manifold_edges",
                          "misoriented_edges", "degenerate_triangles", "closed", "manifold", "oriented", "inside_out",
                          "volume_mm3", "area_mm2", "box_min_mm", "box_max_mm", "unit", "repairs", "warnings"})
    CHECK_THAT(json, Contains('"' + std::string(key) + '"'));
  CHECK_THAT(json, Contains("\"closed\": true") && Contains("inside out"));
}
