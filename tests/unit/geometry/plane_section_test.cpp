// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "c3de/geometry/plane_section.h"
#include "shapes.h"
#include "support/catch.h"

using namespace c3de;
using geometry::planeSection;
using geometry::Polyline;
using geometry::sectionArea;

namespace {

double length(const Polyline &curve) {
  double sum = 0.0;
  const std::size_t n = curve.points.size();
  for (std::size_t i = 0; i + (curve.isClosed ? 0 : 1) < n; ++i)
    sum += norm(curve.points[(i + 1) % n] - curve.points[i]);
  return sum;
}

}  // namespace

TEST_CASE("A plane cuts a ball in one closed circle of the right area, wherever it lies", "[section]") {
  const geometry::TriangleMesh ball = shapes::sphere({10, -4, 7}, 30.0, 5);
  const Vec3 normal = GENERATE(Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0.6, -0.48, 0.64});
  const double height = GENERATE(0.0, 12.5, -21.0);
  const auto curves = planeSection(ball.vertices, ball.triangles, Vec3{10, -4, 7} + height * normal, normal);
  REQUIRE(curves.size() == 1);
  CHECK(curves[0].isClosed);
  for (const Vec3 &p : curves[0].points) CHECK_THAT(dot(p - Vec3{10, -4, 7}, normal), WithinAbs(height, 1e-9));
  // The facets of this ball are at most 1 % of its radius inside it.
  const double area = std::numbers::pi * (900.0 - height * height);
  CHECK(sectionArea(curves, normal) < area);
  CHECK(sectionArea(curves, normal) > 0.99 * area);
}

TEST_CASE("A hollow is cut out of the area, and each body has its own curve", "[section]") {
  geometry::TriangleMesh mesh = shapes::box({0, 0, 0}, {10, 10, 10});
  geometry::TriangleMesh hollow = shapes::box({2, 2, 2}, {5, 5, 5});
  shapes::turnInsideOut(hollow);
  shapes::append(mesh, hollow);
  shapes::append(mesh, shapes::box({20, 0, 0}, {21, 2, 10}));
  const auto curves = planeSection(mesh.vertices, mesh.triangles, {0, 0, 3.5}, {0, 0, 2});
  REQUIRE(curves.size() == 3);
  for (const Polyline &curve : curves) CHECK(curve.isClosed);
  CHECK_THAT(sectionArea(curves, {0, 0, 2}), WithinAbs(100.0 - 9.0 + 2.0, 1e-9));
}

TEST_CASE("A plane through vertices, edges and faces still gives closed curves", "[section]") {
  const geometry::TriangleMesh box = shapes::box({0, 0, 0}, {10, 10, 10});
  // In the plane of a face: the body is behind it, or in front of it.
  CHECK(planeSection(box.vertices, box.triangles, {0, 0, 0}, {0, 0, 1}).empty());
  const auto top = planeSection(box.vertices, box.triangles, {0, 0, 10}, {0, 0, 1});
  REQUIRE(top.size() == 1);
  CHECK(top[0].isClosed);
  CHECK_THAT(sectionArea(top, {0, 0, 1}), WithinAbs(100.0, 1e-9));
  // Through two edges and four corners.
  const auto diagonal = planeSection(box.vertices, box.triangles, {0, 0, 0}, {1, -1, 0});
  REQUIRE(diagonal.size() == 1);
  CHECK(diagonal[0].isClosed);
  CHECK_THAT(sectionArea(diagonal, {1, -1, 0}), WithinAbs(100.0 * std::numbers::sqrt2, 1e-9));
}

TEST_CASE("An open surface gives an open curve in one piece", "[section]") {
  geometry::TriangleMesh cup = shapes::box({0, 0, 0}, {10, 10, 10});
  // Without the wall at y = 10.
  std::erase_if(cup.triangles, [&](const Triangle &t) {
    return cup.vertices[t[0]][1] == 10 && cup.vertices[t[1]][1] == 10 && cup.vertices[t[2]][1] == 10;
  });
  const auto curves = planeSection(cup.vertices, cup.triangles, {0, 0, 5}, {0, 0, 1});
  REQUIRE(curves.size() == 1);
  CHECK_FALSE(curves[0].isClosed);
  CHECK_THAT(length(curves[0]), WithinAbs(30.0, 1e-9));
}

TEST_CASE("Positions of single precision are cut as well, and broken triangles are left out", "[section]") {
  const std::vector<std::array<float, 3>> positions{{0, 0, -1}, {4, 0, -1}, {0, 0, 1}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {0, 1, 9}};
  const auto curves = planeSection(positions, triangles, {0, 0, 0}, {0, 0, 1});
  REQUIRE(curves.size() == 1);
  CHECK_THAT(length(curves[0]), WithinAbs(2.0, 1e-6));
}
