// SPDX-License-Identifier: Apache-2.0
// Soft blocks that slide on flat skins of other bodies: Coulomb's acceleration, for any triangulation.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;

namespace {

// A closed box with its own number of rectangles along each axis; the diagonals are all parallel, or alternate.
Surface gridBox(const Vec3 &low, const Vec3 &high, const std::array<int, 3> &n, bool alternates) {
  Surface s;
  std::map<std::array<int, 3>, Index> known;
  const auto at = [&](const std::array<int, 3> &k) {
    const auto [found, isNew] = known.try_emplace(k, static_cast<Index>(s.positions.size()));
    if (isNew)
      s.positions.push_back(
          low + Vec3(double(k[0]) / n[0], double(k[1]) / n[1], double(k[2]) / n[2]).cwiseProduct(high - low));
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (int i = 0; i < n[a]; ++i)
        for (int j = 0; j < n[b]; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> k{};
            k[axis] = side * n[axis];
            k[a] = i + di;
            k[b] = j + dj;
            return at(k);
          };
          std::array<Index, 4> q{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::swap(q[1], q[3]);
          if (alternates && (i + j) % 2 != 0) q = {q[1], q[2], q[3], q[0]};
          s.triangles.push_back({q[0], q[1], q[2]});
          s.triangles.push_back({q[0], q[2], q[3]});
        }
    }
  return s;
}

struct Slide {
  Integrator integrator = Integrator::automatic;
  double dt = 0.0, degrees = 10.0, friction = 0.0;
  double spacing = 0.012, spacingBelow = 0.04;
  double heading = 0.0;                   // degrees, of the slope about the vertical
  double turn = 0.0;                      // degrees, of the block about the vertical
  std::array<int, 3> squares{40, 1, 10};  // of the slab
  int squaresOfBlock = 8;
  bool alternates = false, softBelow = false;
  double seconds = 1.0, modulus = 5e4;
  double from = 0.0;    // s, start of the speed measurement
  double thrown = 0.0;  // m/s, along the slope
};

Mat3 about(double degrees) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Vec3::UnitY()).toRotationMatrix();
}

// Error of the speed gained along the slope, relative to the speed without friction or to the initial speed.
double errorOfSpeed(const Slide &of) {
  const double angle = of.degrees * std::numbers::pi / 180.0;
  Simulator simulator;
  const Vec3 along = about(of.heading) * Vec3::UnitX();
  simulator.setWorld({.gravity = 9.81 * (std::sin(angle) * along - std::cos(angle) * Vec3::UnitY()),
                      .integrator = of.integrator,
                      .dt = of.dt});
  simulator.world().setContact({true, true, of.friction});
  Material material = soft(of.modulus, 0.45, 20.0);
  BodyShape cube = inside(gridBox(Vec3(-0.03, -0.03, -0.03), Vec3(0.03, 0.03, 0.03),
                                  {of.squaresOfBlock, of.squaresOfBlock, of.squaresOfBlock}, of.alternates));
  cube = turned(cube, about(of.turn));
  // The same block at its position above the slab.
  const Vec3 lift(0, 0.0301, 0);
  BodyShape placed = cube;
  for (Vec3 &x : placed.surface.positions) x += lift;
  placed.min += lift;
  placed.max += lift;
  const auto moved = [lift](std::span<const Vec3> points) {
    std::vector<Vec3> out;
    for (const Vec3 &x : points) out.push_back(x - lift);
    return out;
  };
  placed.inside = [moved, ask = cube.inside](std::span<const Vec3> points, std::span<double> out) {
    ask(moved(points), out);
  };
  placed.surfaceDistance = [moved, ask = cube.surfaceDistance](std::span<const Vec3> points, std::span<double> out) {
    ask(moved(points), out);
  };
  placed.crosses = nullptr;
  const std::size_t id = simulator.addBody(bodyOf(placed, of.spacing, material));
  BodyShape slab = box(Vec3(-0.5, -0.04, -0.2), Vec3(3.5, 0, 0.2));
  slab.surface = gridBox(slab.min, slab.max, of.squares, of.alternates);
  slab = turned(slab, about(of.heading));
  std::vector<Fix> fixes;
  if (of.softBelow) {
    const Fix floor{.region = HalfSpaceRegion{Vec3(0, -0.039, 0), Vec3(0, 1, 0)}};
    fixes.push_back(floor);
  }
  Material below = of.softBelow ? soft(1e6, 0.3, 300.0) : material;
  const std::size_t slabId = simulator.addBody(bodyOf(slab, of.spacingBelow, below, fixes));
  if (!of.softBelow) simulator.world().setRigid(slabId, true);
  if (of.thrown > 0.0) {
    simulator.body(id)->setInitialVelocity(of.thrown * along, Vec3::Zero());
    simulator.body(id)->reset();
  }
  double speedThen = of.thrown, timeThen = 0.0;
  while (simulator.time() < of.seconds - 1e-9) {
    REQUIRE(simulator.step());
    const Vec3 v = shapes::meanVelocity(*simulator.body(id));
    if (simulator.time() <= of.from + 1e-9) {
      timeThen = simulator.time();
      speedThen = v.dot(along);
    }
  }
  const double gained = shapes::meanVelocity(*simulator.body(id)).dot(along) - speedThen;
  const double seconds = simulator.time() - timeThen;
  const double expected = 9.81 * (std::sin(angle) - of.friction * std::cos(angle)) * seconds;
  return (gained - expected) / std::max(of.thrown, 9.81 * std::sin(angle) * seconds);
}

}  // namespace

TEST_CASE("a soft block slides on the flat skin of a rigid body as Coulomb says, whatever the triangles are",
          "[slow]") {
  Slide of;
  of.integrator = GENERATE(Integrator::implicitSdirk, Integrator::backwardEuler, Integrator::explicitVerlet);
  of.friction = GENERATE(0.0, 0.95) * std::tan(of.degrees * std::numbers::pi / 180.0);
  SECTION("as it is") {}
  SECTION("aslant over the triangles") { of.heading = 27.0; }
  SECTION("turned about the vertical") { of.turn = 35.0; }
  SECTION("on fine triangles") {
    of.squares = {160, 1, 40};
    of.alternates = true;
  }
  const double error = errorOfSpeed(of);
  CAPTURE(static_cast<int>(of.integrator), of.friction, of.heading, of.turn, error);
  CHECK(std::abs(error) < 0.02);
}

TEST_CASE("a soft block that is thrown along a flat skin is not caught in long steps") {
  Slide of{.degrees = 0.0, .seconds = 0.4};
  of.integrator = GENERATE(Integrator::implicitSdirk, Integrator::backwardEuler);
  of.thrown = GENERATE(1.2, 2.0, 3.0);  // 20 ... 50 mm a step; the block is 60 mm long
  const double error = errorOfSpeed(of);
  CAPTURE(static_cast<int>(of.integrator), of.thrown, error);
  CHECK(std::abs(error) < 0.02);
}

TEST_CASE("a soft block slides on the flat skin of a soft body as on a rigid one") {
  // The body below is also placed on its support: the speed counts from 0.1 s on.
  Slide of{.softBelow = true, .seconds = 0.5, .from = 0.1};
  of.integrator = GENERATE(Integrator::implicitSdirk, Integrator::explicitVerlet);
  const double error = errorOfSpeed(of);
  CAPTURE(static_cast<int>(of.integrator), error);
  CHECK(std::abs(error) < 0.02);
}
