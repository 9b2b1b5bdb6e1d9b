// SPDX-License-Identifier: Apache-2.0
// What a click and a rectangle select on cubes and spheres, and the values of dragged arrows.
#include "tools/surface_selection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "changed_simulation.h"
#include "tools/arrow_drag.h"

using namespace change_tests;

namespace {

struct Skin {
  std::vector<Vec3> reference;
  std::vector<Vec3f> present;
  std::vector<SurfaceTriangle> triangles;

  explicit Skin(const MeshData &mesh) : triangles(mesh.triangles) {
    for (const Vec3 &x : mesh.positions_mm) {
      reference.push_back(1e-3 * x);
      const Eigen::Vector3f f = reference.back().cast<float>();
      present.push_back({f[0], f[1], f[2]});
    }
  }
  [[nodiscard]] Vec3 centre(std::uint32_t t) const { return centreOf(present, triangles[t]); }
  [[nodiscard]] Vec3 normal(std::uint32_t t) const {
    const auto &[a, b, c] = triangles[t];
    return (reference[b] - reference[a]).cross(reference[c] - reference[a]).normalized();
  }
  [[nodiscard]] std::uint32_t nearest(const Vec3 &place) const {
    std::uint32_t best = 0;
    for (std::uint32_t t = 1; t < triangles.size(); ++t)
      if ((centre(t) - place).norm() < (centre(best) - place).norm()) best = t;
    return best;
  }
  [[nodiscard]] std::vector<std::uint32_t> face(const Vec3 &at, FaceBorder border, double angle_deg) const {
    return faceAround(reference, triangles, TriangleNeighbours(triangles), nearest(at), border, angle_deg);
  }
  template <class Condition>
  [[nodiscard]] std::vector<std::uint32_t> those(const Condition &condition) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      if (condition(t)) out.push_back(t);
    return out;
  }
};

Skin cube(std::uint32_t n) { return Skin(boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0), n)); }

/// A cube whose points are moved onto a sphere of 50 mm.
Skin sphere(std::uint32_t n) {
  MeshData mesh = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0), n);
  for (Vec3 &x : mesh.positions_mm) x = 50.0 * x.normalized();
  return Skin(mesh);
}

/// A pinhole camera 0.4 m before the origin, or parallel rays, of a view of 800 × 600 pixels.
struct TestView {
  Vec3 right, down, view;
  bool isPerspective;
  static constexpr double kScale = 0.001;  // per pixel, of the image plane at distance 1; m if parallel
  TestView(const Vec3 &along, const Vec3 &sideways, bool perspective)
      : right((sideways - sideways.dot(along.normalized()) * along.normalized()).normalized()),
        down(along.normalized().cross(right)), view(along.normalized()), isPerspective(perspective) {}
  [[nodiscard]] Vec3 eye() const { return -0.4 * view; }
  [[nodiscard]] PixelRay ray(double x, double y) const {
    const Vec3 off = kScale * ((x - 400.0) * right + (y - 300.0) * down);
    if (!isPerspective) return {x, y, eye() + 0.4 * off, view};
    return {x, y, eye(), (view + off).normalized()};
  }
  [[nodiscard]] Vec3 pixelOf(const Vec3 &x) const {
    const Vec3 from = x - eye();
    const double depth = from.dot(view), scale = kScale * (isPerspective ? depth : 0.4);
    return {400.0 + from.dot(right) / scale, 300.0 + from.dot(down) / scale, depth};
  }
  [[nodiscard]] ViewFrame frame() const {
    const auto made = ViewFrame::fromRays(ray(120.0, 410.0), ray(333.0, 290.0), view);
    REQUIRE(made);
    return *made;
  }
};

}  // namespace

TEST_CASE("A view is known from the rays of two of its pixels", "[selection]") {
  const bool perspective = GENERATE(true, false);
  const TestView view(Vec3(0.3, -0.7, 0.5), Vec3(1.0, 0.2, 0.1), perspective);
  const auto [dx, dy] = GENERATE(std::pair{3.0, 0.0}, std::pair{0.0, -40.0}, std::pair{-250.0, 90.0});
  const auto frame = ViewFrame::fromRays(view.ray(200.0, 100.0), view.ray(200.0 + dx, 100.0 + dy), view.view);
  REQUIRE(frame);
  CHECK(frame->isPerspective() == perspective);
  for (const Vec3 &x : {Vec3(0.0, 0.0, 0.0), Vec3(0.05, -0.02, 0.04), Vec3(-0.03, 0.06, -0.01)}) {
    const ViewFrame::Pixel pixel = frame->project(x);
    const Vec3 expected = view.pixelOf(x);
    // Three pixels of 800 define the rotation to about 1e-12.
    CHECK(std::abs(pixel.x - expected[0]) < 1e-6);
    CHECK(std::abs(pixel.y - expected[1]) < 1e-6);
    CHECK(std::abs(pixel.depth - expected[2]) < 1e-9);
    CHECK((frame->at(pixel.x, pixel.y, pixel.depth) - x).norm() < 1e-9);
    const PixelRay ray = frame->ray(pixel.x, pixel.y);
    CHECK((x - ray.origin).cross(ray.direction).norm() < 1e-9);
  }
  CHECK_FALSE(ViewFrame::fromRays(view.ray(200.0, 100.0), view.ray(201.0, 100.0), view.view));
}

TEST_CASE("A click on a cube selects the side up to its edges", "[selection]") {
  const std::uint32_t n = GENERATE(1u, 2u, 9u);
  const Skin skin = cube(n);
  const FaceBorder border = GENERATE(FaceBorder::crease, FaceBorder::tilt);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 outwards = sign * Vec3::Unit(axis);
      const auto side = skin.those([&](std::uint32_t t) { return skin.normal(t).dot(outwards) > 0.99; });
      CHECK(side.size() == 2 * n * n);
      for (const double angle : {0.0, 25.0, 89.0}) CHECK(skin.face(0.05 * outwards, border, angle) == side);
    }
  // Sides differ by 90 degrees: a larger angle passes over the edges.
  CHECK(skin.face(Vec3(0.0, 0.0, 0.05), FaceBorder::crease, 90.0).size() == skin.triangles.size());
  CHECK(skin.face(Vec3(0.0, 0.0, 0.05), FaceBorder::tilt, 90.0).size() == 10 * n * n);
}

TEST_CASE("A sphere has no edge, and a tilt selects a cap of it", "[selection]") {
  const Skin skin = sphere(24);
  const Vec3 top(0.0, 0.0, 0.05);
  // Neighbours differ by up to 8 degrees.
  CHECK(skin.face(top, FaceBorder::crease, 15.0).size() == skin.triangles.size());
  CHECK(skin.face(top, FaceBorder::crease, 0.0).size() < 5);
  const Vec3 picked = skin.normal(skin.nearest(top));
  const double limit = std::cos(30.0 * std::numbers::pi / 180.0);
  const auto cap = skin.those([&](std::uint32_t t) { return skin.normal(t).dot(picked) >= limit; });
  CHECK(cap.size() > 100);
  const auto face = skin.face(top, FaceBorder::tilt, 30.0);
  CHECK(std::includes(cap.begin(), cap.end(), face.begin(), face.end()));
  // At the border some triangles touch the others only at a corner.
  CHECK(cap.size() - face.size() < 0.05 * static_cast<double>(cap.size()));
}

TEST_CASE("Parts of a surface that are not connected are separate faces", "[selection]") {
  MeshData both = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0));
  const MeshData other = boxMesh(Vec3(60.0, -50.0, -50.0), Vec3(160.0, 50.0, 50.0));
  const auto first = static_cast<std::uint32_t>(both.positions_mm.size());
  both.positions_mm.insert(both.positions_mm.end(), other.positions_mm.begin(), other.positions_mm.end());
  for (const auto &[a, b, c] : other.triangles) both.triangles.push_back({a + first, b + first, c + first});
  const Skin skin(both);
  const auto face = skin.face(Vec3(0.0, 0.0, 0.05), FaceBorder::crease, 25.0);
  CHECK(face.size() == 8);
  CHECK(std::all_of(face.begin(), face.end(), [&](std::uint32_t t) { return skin.centre(t)[0] < 0.05; }));
}

TEST_CASE("A rectangle selects what is in it, and what faces the viewer if that is wanted", "[selection]") {
  const bool perspective = GENERATE(true, false);
  const Skin skin = GENERATE(0, 1) == 0 ? cube(8) : sphere(16);
  const TestView view(Vec3(0.2, 0.3, -0.9), Vec3::UnitX(), perspective);
  const PixelRect rect{360.0, 220.0, 430.0, 330.0};
  const auto inRect = [&](std::uint32_t t) {
    const Vec3 pixel = view.pixelOf(skin.centre(t));
    return pixel[0] >= rect.left && pixel[0] <= rect.right && pixel[1] >= rect.top && pixel[1] <= rect.bottom;
  };
  const auto all = skin.those(inRect);
  const auto facing = skin.those([&](std::uint32_t t) {
    const Vec3 sight = perspective ? Vec3(skin.centre(t) - view.eye()) : view.view;
    return inRect(t) && skin.normal(t).dot(sight) < 0.0;
  });
  CHECK(facing.size() > 10);
  CHECK(facing.size() < all.size());
  CHECK(trianglesInRect(skin.present, skin.triangles, view.frame(), rect, false) == all);
  CHECK(trianglesInRect(skin.present, skin.triangles, view.frame(), rect, true) == facing);
  CHECK(trianglesInRect(skin.present, skin.triangles, view.frame(), {10.0, 10.0, 60.0, 60.0}, false).empty());
}

TEST_CASE("What is behind the eye is not in a rectangle", "[selection]") {
  const Skin skin = cube(4);
  TestView view(-Vec3::UnitZ(), Vec3::UnitX(), true);
  const auto ray = [&](double x, double y) {
    PixelRay out = view.ray(x, y);
    out.origin = Vec3::Zero();  // in the middle of the cube
    return out;
  };
  const auto frame = ViewFrame::fromRays(ray(0.0, 0.0), ray(800.0, 600.0), view.view);
  REQUIRE(frame);
  const auto found = trianglesInRect(skin.present, skin.triangles, *frame, {0.0, 0.0, 800.0, 600.0}, false);
  CHECK_FALSE(found.empty());
  CHECK(std::all_of(found.begin(), found.end(), [&](std::uint32_t t) { return skin.centre(t)[2] < 0.0; }));
}

TEST_CASE("A rectangle in a slice selects the surface within its depth", "[selection]") {
  const Skin skin = cube(10);  // triangles of 10 mm
  const TestView view(Vec3::UnitZ(), Vec3::UnitX(), false);
  const ViewFrame frame = [&] {
    PixelRay a = view.ray(400.0, 300.0), b = view.ray(500.0, 400.0);
    a.origin[2] = b.origin[2] = 0.0;  // the plane z = 0
    const auto made = ViewFrame::fromRays(a, b, view.view);
    REQUIRE(made);
    return *made;
  }();
  const auto pixel = [&](double x, double y) { return frame.project(Vec3(x, y, 0.0)); };
  const auto low = pixel(0.045, -0.0195), high = pixel(0.055, 0.0195);
  const PixelRect rect{std::min(low.x, high.x), std::min(low.y, high.y), std::max(low.x, high.x),
                       std::max(low.y, high.y)};
  // Of the side x = 50 mm: y within ±19.5 mm has parts of four squares, and a depth of 12 mm reaches two to each side.
  const auto found = trianglesInSlab(skin.present, skin.triangles, frame, rect, -0.012, 0.012);
  CHECK(found.size() == 2 * 4 * 4);
  for (const std::uint32_t t : found) CHECK(skin.normal(t)[0] > 0.99);
  // A thin slab selects the squares that it cuts.
  CHECK(trianglesInSlab(skin.present, skin.triangles, frame, rect, 0.0011, 0.0012).size() == 2 * 4);
  CHECK(trianglesInSlab(skin.present, skin.triangles, frame, rect, 0.06, 0.07).empty());
  // A rectangle within one large triangle selects it.
  const Skin coarse = cube(1);
  CHECK(trianglesInSlab(coarse.present, coarse.triangles, frame, rect, 0.0301, 0.0302).size() >= 1);
}

TEST_CASE("A dragged tip changes the value of a load, rounded and within its range", "[selection]") {
  ConditionSnapshot one;
  const MeshData mesh = boxMesh(Vec3::Constant(-50.0), Vec3::Constant(50.0));
  one.condition.name = "load";
  for (const Vec3 &x : mesh.positions_mm) one.condition.patch.positions.push_back(1e-3 * x);
  for (const auto &t : mesh.triangles)
    if (std::all_of(t.begin(), t.end(), [&](std::uint32_t c) { return mesh.positions_mm[c][2] > 49.0; }))
      one.condition.patch.triangles.push_back(t);
  one.positions = one.condition.patch.positions;
  const Vec3 area(0.0, 0.0, 0.01);
  constexpr double kScale = 0.02;  // m per N

  one.condition.kind = ConditionKind::force;
  one.condition.vector = Vec3(0.0, 0.0, -2.0);
  ConditionArrow arrow = arrowOf(one, kScale);
  CHECK((arrow.vector - Vec3(0.0, 0.0, -0.04)).norm() < 1e-12);
  CHECK((arrow.area - area).norm() < 1e-12);
  CHECK(forceOf(one) == 2.0);
  const SurfaceCondition pulled = withArrow(one.condition, arrow, Vec3(0.0246913, 0.0, 0.0), kScale);
  CHECK((pulled.vector - Vec3(1.23, 0.0, 0.0)).norm() < 1e-12);
  CHECK(valueText(pulled) == "1.23 N");
  CHECK(withArrow(one.condition, arrow, Vec3(1e9, 0.0, 0.0), kScale).vector.norm() <= kMaxForce);
  CHECK(withArrow(one.condition, arrow, Vec3::Zero(), kScale).vector == Vec3::Zero());
  CHECK(problemOf(withArrow(one.condition, arrow, Vec3::Zero(), kScale)).empty());

  one.condition.kind = ConditionKind::displace;
  const SurfaceCondition moved = withArrow(one.condition, arrow, Vec3(0.0, 0.003456, 0.0), kScale);
  CHECK((moved.vector - Vec3(0.0, 0.00346, 0.0)).norm() < 1e-12);
  CHECK(valueText(moved) == "3.46 mm");

  one.condition.kind = ConditionKind::pressure;
  one.condition.pressure = 20.0 * 133.322;
  CHECK(valueText(one.condition) == "2.666 kPa (20 mmHg)");
  arrow = arrowOf(one, kScale);
  CHECK((arrow.vector + kScale * one.condition.pressure * area).norm() < 1e-9);
  CHECK(std::abs(forceOf(one) - 26.6644) < 1e-6);
  // Only along its normal; outwards is suction.
  CHECK(withArrow(one.condition, arrow, Vec3(0.1, 0.1, -0.0200), kScale).pressure == 100.0);
  CHECK(withArrow(one.condition, arrow, Vec3(0.0, 0.0, 0.0200), kScale).pressure == -100.0);
  CHECK(withArrow(one.condition, arrow, Vec3(0.0, 0.0, -1e9), kScale).pressure == kMaxPressure);
  one.condition.kind = ConditionKind::fix;
  CHECK(withArrow(one.condition, arrow, Vec3(0.1, 0.0, 0.0), kScale).vector == one.condition.vector);
}

TEST_CASE("A tip follows the mouse in the plane of the screen, and that of a pressure along the normal",
          "[selection]") {
  ConditionArrow arrow;
  arrow.from = Vec3(0.0, 0.0, 0.05);
  arrow.vector = Vec3(0.0, 0.0, -0.02);
  arrow.area = Vec3(0.0, 0.0, 0.01);
  const Vec3 view = Vec3(0.0, 1.0, -0.5).normalized();
  const Vec3 eye = arrow.tip() - 0.4 * view;
  const PickRay ray{eye, (arrow.tip() + Vec3(0.01, 0.0, 0.0) - eye).normalized(), view};
  for (const ConditionKind kind : {ConditionKind::force, ConditionKind::displace}) {
    const auto tip = tipUnder(ray, arrow, kind, false);
    REQUIRE(tip);
    CHECK((*tip - arrow.tip() - Vec3(0.01, 0.0, 0.0)).norm() < 1e-12);
  }
  const auto along = tipUnder(ray, arrow, ConditionKind::pressure, false);
  REQUIRE(along);
  CHECK(std::hypot((*along)[0], (*along)[1]) < 1e-12);
  // A normal towards the viewer has no length on the screen.
  const PickRay facing{Vec3(0.0, 0.0, 0.5), -Vec3::UnitZ(), -Vec3::UnitZ()};
  CHECK_FALSE(tipUnder(facing, arrow, ConditionKind::pressure, false));
  const PickRay away{Vec3(0.0, 0.0, 0.5), Vec3::UnitZ(), Vec3::UnitZ()};
  CHECK_FALSE(tipUnder(away, arrow, ConditionKind::force, false));
  // A slice has its tip in front of or behind the plane.
  CHECK(tipUnder(away, arrow, ConditionKind::force, true));
}
