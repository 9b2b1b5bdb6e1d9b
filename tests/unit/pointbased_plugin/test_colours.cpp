// SPDX-License-Identifier: Apache-2.0
// Colours of values: the map, the range, and when they are recomputed.
#include <cmath>
#include <limits>

#include "fields/colouring.h"
#include "lattice_cases.h"
#include "support/catch.h"

using namespace pointbased;

namespace {

double linearOf(std::uint8_t byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// CIE lightness and chromaticities, D65: another colour space than the one in which the map is made.
Vec3 cieLab(const Rgba8 &c) {
  const double r = linearOf(c[0]), g = linearOf(c[1]), b = linearOf(c[2]);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

std::unique_ptr<Body> bar() {
  BodyRecipe recipe;
  recipe.sampling = lattice_cases::withSpacing(0.01);
  const BodyShape shape = lattice_cases::box(Vec3::Zero(), Vec3(0.08, 0.02, 0.02));
  std::vector<Vec3> normals(shape.surface.positions.size(), Vec3::UnitX());
  auto rest = buildRestState(shape, recipe, normals, serialFor());
  if (!rest) throw std::runtime_error(rest.error());
  Material material;
  material.youngsModulus = 1e4;
  material.poissonRatio = 0.0;
  material.law = MaterialLaw::linear;
  return std::make_unique<Body>("bar", *rest, Constitution{{material}, kLatticeStabilisation}, serialFor());
}

void stretch(Body &body, double strain) {
  for (std::size_t i = 0; i < body.rest().phyxelCount(); ++i)
    body.state().displacements[i] = Vec3(strain * (body.rest().origin + body.rest().positions[i])[0], 0, 0);
  body.computeGradients(serialFor());
}

ViewSettings coloured(ColourBy by) {
  ViewSettings view;
  view.surface = SurfaceShown::transparent;
  view.colourBy = by;
  return view;
}

BodyValues valuesOf(const Body &body, const ViewSettings &view) {
  BodyValues values;
  ValueReader().read(body, view, {}, serialFor(), values);
  return values;
}

using Clock = Colouring::Clock;
constexpr auto kLater = std::chrono::hours(1);

}  // namespace

TEST_CASE("Along the colour map the lightness grows and equal steps look alike") {
  const auto &map = colourMap();
  std::vector<double> steps;
  for (std::size_t i = 16; i < kColours; i += 16) {
    const Vec3 a = cieLab(map[i - 16]), b = cieLab(map[i]);
    CHECK(b[0] > a[0] + 1.0);
    steps.push_back((b - a).norm());
  }
  // The two spaces agree within a third on the size of a step; a rainbow differs by a factor of five.
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  CHECK(*most / *least < 2.0);
  CHECK(cieLab(map.front())[0] < 25.0);
  CHECK(cieLab(map.back())[0] > 85.0);
}

TEST_CASE("A value beyond the range has the colour of its end") {
  CHECK(colourOf(-3.0, 0.0, 2.0) == colourMap().front());
  CHECK(colourOf(0.0, 0.0, 2.0) == colourMap().front());
  CHECK(colourOf(2.0, 0.0, 2.0) == colourMap().back());
  CHECK(colourOf(9.0, 0.0, 2.0) == colourMap().back());
  CHECK(colourOf(std::numeric_limits<double>::quiet_NaN(), 0.0, 2.0) == colourMap().back());
  CHECK(colourOf(1.0, 0.0, 2.0) == colourMap()[128]);
}

TEST_CASE("The values of a stretched bar are its displacement in mm and its stress in kPa") {
  const auto body = bar();
  stretch(*body, 0.05);
  const BodyValues moved = valuesOf(*body, coloured(ColourBy::displacement));
  const RestState &rest = body->rest();
  REQUIRE(moved.surfels.size() == rest.surfels.count());
  for (std::size_t p = 0; p < moved.surfels.size(); ++p)
    CHECK_THAT(moved.surfels[p], WithinAbs(50.0 * (rest.origin + rest.surfels.position(p, rest.positions))[0], 1e-9));

  const BodyValues stressed = valuesOf(*body, coloured(ColourBy::vonMises));
  REQUIRE(stressed.points.size() == rest.pointCount());
  for (const double value : stressed.surfels) CHECK_THAT(value, WithinRel(0.5, 1e-9));  // E ε = 500 Pa
  for (const double value : stressed.points) CHECK_THAT(value, WithinRel(0.5, 1e-9));

  // A uniform state has no error and needs no stabilisation.
  for (const ColourBy by : {ColourBy::error, ColourBy::stabilisation})
    for (const double value : valuesOf(*body, coloured(by)).surfels) CHECK_THAT(value, WithinAbs(0.0, 1e-4));
}

TEST_CASE("What is shown of the error is the estimate, in per cent") {
  const auto body = bar();
  for (std::size_t i = 0; i < body->rest().phyxelCount(); ++i) {
    const double x = (body->rest().origin + body->rest().positions[i])[0];
    body->state().displacements[i] = Vec3(4.0 * x * x * x, 0, 0);
  }
  body->computeGradients(serialFor());
  std::vector<double> perPhyxel;
  const ErrorEstimate estimate = estimateError(*body, &perPhyxel);
  ViewSettings view = coloured(ColourBy::error);
  view.points = PointsShown::phyxels;
  const BodyValues values = valuesOf(*body, view);
  CHECK_THAT(values.whole, WithinRel(100.0 * estimate.relative, 1e-12));
  REQUIRE(values.points.size() == perPhyxel.size());
  for (std::size_t i = 0; i < perPhyxel.size(); ++i)
    CHECK_THAT(values.points[i], WithinRel(100.0 * perPhyxel[i], 1e-12));
  CHECK(values.whole > 1.0);
}

TEST_CASE("The range of contact pressures is that of the places where something presses") {
  const auto body = bar();
  Colouring colouring;
  colouring.setPressures([&](std::uint64_t id, std::vector<double> &out) {
    REQUIRE(id == 7);
    out.assign(body->rest().phyxelCount(), 0.0);
    out.front() = 1900.0;  // Pa, at one corner only
  });
  REQUIRE(colouring.update({{7, body.get()}}, coloured(ColourBy::contactPressure), serialFor()));
  REQUIRE(colouring.scale());
  CHECK(colouring.scale()->unit == "kPa");
  CHECK(colouring.scale()->high > 0.5);
  CHECK(colouring.scale()->high <= 2.0);
}

TEST_CASE("Ranges are round numbers that nearly all values stay below") {
  CHECK(roundedUp(1.0) == Approx(1.0));
  CHECK(roundedUp(1.01) == Approx(1.5));
  CHECK(roundedUp(8.2) == Approx(10.0));
  CHECK(roundedUp(0.0231) == Approx(0.025));
  CHECK(roundedUp(3e5) == Approx(3e5));

  std::vector<double> values(100, 1.9);
  values.back() = 500.0;  // one point at a clamp
  AutoRange range;
  CHECK(range.update(values, 1e-3) == Approx(2.0));
  // It is constant while values move within it, grows at once, and shrinks when they are far below.
  CHECK(range.update(std::vector<double>(10, 1.2), 1e-3) == Approx(2.0));
  CHECK(range.update(std::vector<double>(10, 2.1), 1e-3) == Approx(2.5));
  CHECK(range.update(std::vector<double>(10, 0.5), 1e-3) == Approx(0.5));
  CHECK(range.update({}, 1e-3) == Approx(1e-3));
  CHECK(range.update({std::numeric_limits<double>::quiet_NaN()}, 1e-3) == Approx(1e-3));
}

TEST_CASE("By the material there are no colours, no legend and no work") {
  const auto body = bar();
  Colouring colouring;
  CHECK(colouring.update({{1, body.get()}}, coloured(ColourBy::material), serialFor()));
  CHECK(!colouring.scale());
  CHECK(colouring.of(1) == nullptr);
}

TEST_CASE("A fixed range is kept, and the legend says what lies beyond it") {
  const auto body = bar();
  stretch(*body, 0.05);
  Colouring colouring;
  ViewSettings view = coloured(ColourBy::vonMises);
  view.range = 0.25;
  REQUIRE(colouring.update({{1, body.get()}}, view, serialFor()));
  REQUIRE(colouring.scale());
  CHECK(colouring.scale()->high == 0.25);
  CHECK(colouring.scale()->unit == "kPa");
  CHECK(colouring.scale()->note == "largest 0.5 kPa");
  for (const Rgba8 &colour : colouring.of(1)->surfels) CHECK(colour == colourMap().back());
}

TEST_CASE("Colours are found at most thirty times a second, at once when something else is to be shown") {
  const auto body = bar();
  stretch(*body, 0.05);
  Colouring colouring;
  const Colouring::Bodies bodies{{1, body.get()}};
  const Clock::time_point begin = Clock::now();
  REQUIRE(colouring.update(bodies, coloured(ColourBy::displacement), serialFor(), begin));
  const double before = colouring.scale()->high;
  stretch(*body, 0.2);
  CHECK(!colouring.update(bodies, coloured(ColourBy::displacement), serialFor(), begin));
  CHECK(colouring.scale()->high == before);
  CHECK(colouring.update(bodies, coloured(ColourBy::displacement), serialFor(), begin + kLater));
  CHECK(colouring.scale()->high > before);
  CHECK(colouring.update(bodies, coloured(ColourBy::error), serialFor(), begin + kLater));
  CHECK(colouring.scale()->title.find("error") != std::string::npos);
  // Another body of the same id, rebuilt: its colours are not those of the previous one.
  const auto other = bar();
  CHECK(colouring.update({{1, other.get()}}, coloured(ColourBy::error), serialFor(), begin + kLater));
  CHECK(colouring.of(1)->rest == &other->rest());
}
