// SPDX-License-Identifier: Apache-2.0
// Contact between bodies: against a finite element reference, and at extremes.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "contact_cases.h"
#include "crossing_triangles.h"
#include "ring_and_bowl.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kModulus = 1e4;  // Pa
constexpr double kGravity = 9.81;

void setGravity(Simulator &simulator, double damping = 0.0) {
  simulator.setWorld({.gravity = Vec3(0, -kGravity, 0), .damping = damping});
}

std::vector<Vec3> skinOf(Simulator &simulator, std::size_t id) {
  std::vector<Vec3> positions, normals;
  simulator.world().surfels(id, positions, normals);
  return positions;
}

double fastestOf(Simulator &simulator) {
  double fastest = 0.0;
  for (const std::size_t id : simulator.bodyIds())
    fastest = std::max(fastest, largest(simulator.body(id)->state().velocities));
  return fastest;
}

// Of all pairs.
std::size_t crossingsOfAll(Simulator &simulator) {
  const std::vector<std::size_t> ids = simulator.bodyIds();
  std::vector<Vec3> lows, highs;
  for (const std::size_t id : ids) {
    lows.push_back(Vec3::Constant(1e300));
    highs.push_back(Vec3::Constant(-1e300));
    for (const Vec3 &x : skinOf(simulator, id)) {
      lows.back() = lows.back().cwiseMin(x);
      highs.back() = highs.back().cwiseMax(x);
    }
  }
  std::size_t found = 0;
  for (std::size_t a = 0; a < ids.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if ((lows[a].array() <= highs[b].array()).all() && (lows[b].array() <= highs[a].array()).all())
        found += shapes::crossings(simulator, ids[b], ids[a]);
  return found;
}

// Largest rise of the energy of all bodies above an earlier value, J.
struct EnergyWatch {
  double least = std::numeric_limits<double>::infinity(), rise = 0.0;
  void look(double energy) {
    least = std::min(least, energy);
    rise = std::max(rise, energy - least);
  }
};

// A ball by its formula, with a skin of n faces around the equator.
BodyShape ballShape(const Vec3 &centre, double radius, int n) {
  BodyShape shape = shapes::ball(centre, radius);
  shape.surface = ballSurface(centre, radius, n);
  return shape;
}

// Of a ball about the y axis; triangles grow from the pole, where their size is `finest`.
Surface gradedBall(const Vec3 &centre, double radius, double finest, int around, bool fromTop) {
  std::vector<double> angles{0.0};
  while (angles.back() < std::numbers::pi)
    angles.push_back(angles.back() + finest / radius * std::clamp(angles.back() / 0.3, 1.0, 8.0));
  const std::size_t rings = angles.size();
  Surface s;
  for (std::size_t i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = std::numbers::pi * angles[i] / angles.back(), phi = 2.0 * std::numbers::pi * j / around;
      const double ring = i == 0 || i + 1 == rings ? 0.0 : std::sin(theta), up = fromTop ? 1.0 : -1.0;
      s.positions.push_back(centre + radius * Vec3(ring * std::cos(phi), up * std::cos(theta), ring * std::sin(phi)));
    }
  const auto at = [&](std::size_t i, int j) { return static_cast<Index>(static_cast<int>(i) * around + j % around); };
  const auto add = [&](Index a, Index b, Index c) {
    s.triangles.push_back(fromTop ? std::array{a, b, c} : std::array{a, c, b});
  };
  for (std::size_t i = 0; i + 1 < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) add(at(i, j), at(i, j + 1), at(i + 1, j));
      if (i + 2 < rings) add(at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
    }
  return s;
}

constexpr double kRadius = 0.05;  // m
// F/(E R²) at a depth of 0.02 R and nu = 0.3, neo-Hookean: tests/validation/truths/pressed_balls.py. Hertz's formula
// for half-spaces is 9 % lower.
constexpr double kReference = 4.549e-3;
constexpr double kOffset = 0.02;  // spacings of the cells there: skins touch at it (docs/theory/contact.md)

// Two balls whose outer halves are held and move towards each other, each by 0.02 R from the point of contact. Cells
// are a quarter of the spacing where they press. The skins do not match, so that vertices meet faces.
// @return N
double forceOfPressedBalls(double spacing, LatticeOrder order) {
  Simulator simulator;
  simulator.setWorld({.integrator = Integrator::quasiStatic, .loadSteps = 2});
  simulator.world().setContact({true, false, 0.0});
  const double apart = 2.0 * kOffset * spacing;
  std::array<std::size_t, 2> ids{};
  for (const bool isUpper : {false, true}) {
    const double up = isUpper ? 1.0 : -1.0;
    const Vec3 centre(0, up * (kRadius + 0.5 * apart), 0);
    BodyShape shape = shapes::ball(centre, kRadius);
    shape.surface = gradedBall(centre, kRadius, (isUpper ? 0.0226 : 0.02) * kRadius, isUpper ? 56 : 64, !isUpper);
    BodyRecipe recipe{.sampling = {.spacing = spacing, .order = order}};
    recipe.sampling.refinements.push_back(
        {SphereRegion{centre - up * Vec3(0, kRadius, 0), 0.3 * kRadius}, 0.25 * spacing});
    recipe.fixes.push_back({.region = HalfSpaceRegion{centre, Vec3(0, -up, 0)},
                            .displacement = Vec3(0, -up * (0.5 * apart + 0.02 * kRadius), 0)});
    ids[isUpper ? 1 : 0] = simulator.addBody(shapes::makeBody(shapes::restState(shape, recipe), {soft(kModulus, 0.3)}));
  }
  while (!simulator.finished()) REQUIRE(simulator.step());
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const ContactSummary *found = between(contacts, ids[0], ids[1]);
  REQUIRE(found);
  // Contact is solved until its forces change by less than 1 %.
  const std::vector<Reaction> reactions = simulator.diagnostics().reactions(ids[1]);
  REQUIRE(reactions.size() == 1);
  CHECK_THAT(-reactions[0].force[1], WithinRel(-found->force[1], 0.01));
  return -found->force[1];
}

double errorOfPressedBalls(double spacing, LatticeOrder order = LatticeOrder::linear) {
  return forceOfPressedBalls(spacing, order) / (kReference * kModulus * kRadius * kRadius) - 1.0;
}

}  // namespace

TEST_CASE("two balls pressed together push back as finite elements say, the better the finer they are") {
  const double coarse = errorOfPressedBalls(kRadius / 4.0), middle = errorOfPressedBalls(kRadius / 6.0),
               fine = errorOfPressedBalls(kRadius / 8.0);
  CAPTURE(coarse, middle, fine);
  // +7.2, +4.1 and +2.9 %: 2.3, 3.4 and 4.5 cells on the radius of the contact, 0.14 R. Skins touch 0.02 of these cells
  // before they meet: 0.6 to 0.3 % of this depth each.
  CHECK(std::abs(coarse) < 0.08);
  CHECK(std::abs(middle) < std::abs(coarse));
  CHECK(std::abs(fine) < std::abs(middle));
  CHECK(std::abs(fine) < 0.03);  // the target
}

// +20, +13 and +9.5 %: three times the errors of first order. The accuracy setting does not predict contact.
TEST_CASE("second order: two balls pressed together are too stiff, the less the finer they are", "[slow]") {
  const auto error = [](double cells) { return errorOfPressedBalls(kRadius / cells, LatticeOrder::quadratic); };
  const double coarse = error(4.0), middle = error(6.0), fine = error(8.0);
  CAPTURE(coarse, middle, fine);
  CHECK(coarse < 0.21);
  CHECK(middle < 0.14);
  CHECK(fine < 0.1);
  CHECK(0.0 < fine);
}

namespace {

struct Squeezed {
  std::size_t crossed = 0;
  double deepest = 0.0, deepestPoint = 0.0;  // m, of the drawn skin and of the points of contact, in the ring
  double pressing = 0.0;                     // N, largest
  double way = 0.0, width = 0.0;             // m, downwards, and across at the end
};

// A ball of 40 mm that is pulled by its lower cap through a ring.
Squeezed pullThrough(double opening) {
  const double radius = 0.04, tube = 0.012, spacing = 0.008;
  const Vec3 ring(0, -0.05, 0);
  Simulator simulator;
  setGravity(simulator, 2.0);
  simulator.world().setContact({true, true, 0.3});
  const std::size_t obstacle = simulator.addObstacle(torus(ring, opening + tube, tube, 0.2));
  const Fix cap{.region = HalfSpaceRegion{Vec3(0, -0.75 * radius, 0), Vec3(0, 1, 0)},
                .displacement = Vec3(0, -0.12, 0),
                .ramp = 0.8};
  const std::size_t id =
      simulator.addBody(bodyOf(ballShape(Vec3::Zero(), radius, 16), spacing, soft(kModulus, 0.3, 5.0), {cap}));
  Squeezed seen;
  const auto depthOf = [&](const Vec3 &x) { return -distanceToTorus(x, ring, opening + tube, tube); };
  while (simulator.time() < 1.2) {
    REQUIRE(simulator.step());
    for (const ContactSummary &c : simulator.diagnostics().contacts())
      if (c.second == obstacle) seen.pressing = std::max(seen.pressing, c.normalForce);
    if (simulator.steps() % 16 != 0) continue;
    seen.crossed += shapes::crossings(simulator, id);
    for (const Vec3 &x : skinOf(simulator, id)) seen.deepest = std::max(seen.deepest, depthOf(x));
    for (const Vec3 &x : simulator.body(id)->contactPositions(serialFor()))
      seen.deepestPoint = std::max(seen.deepestPoint, depthOf(x));
  }
  REQUIRE(simulator.stepper().stoppedBodies() == 0);
  seen.way = -shapes::meanDisplacement(*simulator.body(id))[1];
  const Extent across = shapes::extent(*simulator.body(id), Vec3::UnitX());
  seen.width = across.high - across.low;
  return seen;
}

}  // namespace

TEST_CASE("a ball that is pulled through a ring 30 % narrower than itself does not enter it, nor does its skin fold") {
  const Squeezed seen = pullThrough(0.028);
  CAPTURE(seen.deepest, seen.deepestPoint, seen.pressing, seen.way, seen.width);
  CHECK(seen.crossed == 0);
  // Points of contact stop at the surface; the skin between them, half a spacing apart, may cut in.
  CHECK(seen.deepestPoint < 0.01 * 0.008);
  CHECK(seen.deepest < 0.1 * 0.008);
  CHECK(seen.pressing > 10.0);  // its weight is 2.6 N
  CHECK_THAT(seen.way, WithinRel(0.12, 0.05));
  CHECK_THAT(seen.width, WithinRel(0.08, 0.02));
}

TEST_CASE("the skin of a ball that is pulled through a ring 45 % narrower than itself does not cross itself",
          "[.missed]") {
  CHECK(pullThrough(0.022).crossed == 0);
}

TEST_CASE("six soft bodies that fall into a bowl come to rest there and do not cross") {
  Simulator simulator;
  setGravity(simulator);
  simulator.world().setContact({true, false, 0.3});
  const double radius = 0.12, spacing = 0.02;
  simulator.addObstacle(bowl(radius, 0.3));
  const Material material = soft(2e4, 0.3, 10.0);
  for (int k = 0; k < 6; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k % 3) / 3.0 + (k < 3 ? 0.0 : 0.5), out = 0.055;
    const Vec3 centre(out * std::cos(angle), k < 3 ? -0.02 : 0.07, out * std::sin(angle)), half = Vec3::Constant(0.028);
    // Edges below 0.75 spacings: the triangles of contact are the drawn ones.
    simulator.addBody(k % 2 == 0 ? bodyOf(ballShape(centre, 0.035, 12), spacing, material)
                                 : block(centre - half, centre + half, spacing, material, 6));
  }
  EnergyWatch energy;
  std::size_t crossed = 0;
  double beyond = 0.0;
  while (simulator.time() < 10.0) {
    REQUIRE(simulator.step());
    energy.look(totalOf(simulator).energy);
    if (simulator.steps() % 32 != 0) continue;
    crossed += crossingsOfAll(simulator);
    for (const std::size_t id : simulator.bodyIds())
      for (const Vec3 &x : skinOf(simulator, id))
        beyond = std::max(beyond, (x[1] < 0.0 ? x.norm() : std::hypot(x[0], x[2])) - radius);
  }
  CAPTURE(energy.least, energy.rise, beyond, fastestOf(simulator));
  CHECK(simulator.stepper().stoppedBodies() == 0);
  CHECK(crossed == 0);
  // A corner may cut in between points of contact, half a spacing apart, when it arrives.
  CHECK(beyond < 0.5 * spacing);
  CHECK(energy.least < -0.5);                 // J: they have fallen
  CHECK(energy.rise < -1e-4 * energy.least);  // the oscillation of velocity Verlet
  CHECK(fastestOf(simulator) < 0.02);         // m/s; they arrived with more than 1
}

namespace {

struct Fallen {
  std::size_t crossed = 0, touching = 0;   // pairs of triangles, in all checks; pairs of bodies, largest
  double start = 0.0, rise = 0.0;          // J, of energy
  double imbalance = 0.0, momentum = 0.0;  // N s, of a step and largest
};

// Fifty bodies of 30 mm that fall on the floor and on each other for half a second.
// @param bodyAt  the kth of them, about its middle
Fallen dropFifty(const std::function<std::unique_ptr<Body>(int k, const Vec3 &middle)> &bodyAt, double apart) {
  Simulator simulator;
  setGravity(simulator);
  simulator.world().setContact({true, false, 0.3});
  const std::size_t floor = simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.5));
  support::Random random(5);
  Fallen seen;
  double mass = 0.0;
  for (int k = 0; k < 50; ++k) {
    const int layer = k / 16, row = k / 4 % 4, column = k % 4;
    const Vec3 middle = apart * Vec3(column, 0.6 + layer, row) + 0.002 * random.vector();
    const std::size_t id = simulator.addBody(bodyAt(k, middle));
    mass += simulator.body(id)->totalMass();
    seen.start += simulator.body(id)->totalMass() * kGravity * middle[1];
  }
  EnergyWatch energy;
  Total before = totalOf(simulator);
  while (simulator.time() < 0.5) {
    const double then = simulator.time();
    REQUIRE(simulator.step());
    const Total now = totalOf(simulator);
    energy.look(now.energy);
    Vec3 force = mass * Vec3(0, -kGravity, 0);
    const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
    for (const ContactSummary &c : contacts)
      if (c.second == floor) force += c.force;
    seen.imbalance =
        std::max(seen.imbalance, (now.momentum - before.momentum - (simulator.time() - then) * force).norm());
    seen.momentum = std::max(seen.momentum, now.momentum.norm());
    before = now;
    seen.touching = std::max(seen.touching, contacts.size());
    if (simulator.steps() % 16 == 0) seen.crossed += crossingsOfAll(simulator);
  }
  REQUIRE(simulator.stepper().stoppedBodies() == 0);
  seen.rise = energy.rise;
  return seen;
}

}  // namespace

TEST_CASE("fifty blocks and balls that fall in a loose pile keep their momentum, gain no energy and do not cross") {
  const Material material = soft(2e4, 0.3);
  const Vec3 half = Vec3::Constant(0.0155);
  const Fallen seen = dropFifty(
      [&](int k, const Vec3 &middle) {
        return k % 2 == 0 ? block(middle - half, middle + half, 0.0155, material, 5)
                          : bodyOf(ballShape(middle, 0.016, 8), 0.012, material);
      },
      0.037);
  CAPTURE(seen.touching, seen.rise, seen.start, seen.imbalance, seen.momentum);
  CHECK(seen.touching > 50);
  CHECK(seen.crossed == 0);
  CHECK(seen.rise < 1e-4 * seen.start);
  CHECK(seen.imbalance < 1e-12 * seen.momentum);  // weight and floor; the impulses between bodies cancel
}

// Edges meet edges.
TEST_CASE("fifty blocks that fall in a loose pile, turned at random, do not cross", "[.missed]") {
  support::Random random(GENERATE(1u, 2u, 3u, 4u));
  const Fallen seen = dropFifty(
      [&](int, const Vec3 &middle) {
        const Vec3 axis = random.vector().normalized();
        const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi * random(), axis).toRotationMatrix();
        Surface cube = boxSurface(Vec3::Constant(-0.015), Vec3::Constant(0.015), 4);
        for (Vec3 &x : cube.positions) x = middle + turn * x;
        return bodyOf(shapes::inside(cube), 0.015, soft(2e4, 0.3));
      },
      0.056);
  CHECK(seen.crossed == 0);
}

namespace {

struct Overlapping {
  double fastest = 0.0;     // m/s, of all phyxels
  double leaves = 0.0;      // m/s, largest, of a body as a whole
  double energy = 0.0;      // J, largest
  std::size_t crossed = 0;  // at the end
  std::string told;
};

// Two blocks of 50 mm, half of one inside the other, the other wider by `wider` on each side.
Overlapping overlapByHalf(double wider, double time) {
  Simulator simulator;
  simulator.world().setContact({true, false, 0.0});
  const Material material = soft(kModulus, 0.3);
  const std::size_t a = simulator.addBody(block(Vec3::Zero(), Vec3::Constant(0.05), 0.01, material, 8));
  const std::size_t b = simulator.addBody(
      block(Vec3(0.025, 0.003 - wider, 0.002 - wider), Vec3(0.075, 0.053 + wider, 0.052 + wider), 0.01, material, 8));
  Overlapping seen;
  while (simulator.time() < time) {
    REQUIRE(simulator.step());
    seen.fastest = std::max(seen.fastest, fastestOf(simulator));
    for (const std::size_t id : {a, b})
      seen.leaves = std::max(seen.leaves, shapes::meanVelocity(*simulator.body(id)).norm());
    seen.energy = std::max(seen.energy, totalOf(simulator).energy);
  }
  REQUIRE(simulator.stepper().stoppedBodies() == 0);
  seen.crossed = shapes::crossings(simulator, a, b);
  for (const SimulationEvent &event : simulator.diagnostics().events())
    if (event.kind == "overlap") seen.told += event.text;
  return seen;
}

}  // namespace

TEST_CASE("blocks of which one is half inside the other from the start are told of and get no jolt") {
  const double wider = GENERATE(0.0, 0.012);
  const Overlapping seen = overlapByHalf(wider, 8.0);
  CAPTURE(wider, seen.told, seen.fastest, seen.leaves, seen.energy);
  CHECK_THAT(seen.told, Contains("mm deep where they meet; it is removed at 5 mm a second at most"));
  CHECK_THAT(seen.told, Contains("begin with bodies that do not overlap"));
  CHECK(seen.fastest < 0.3);  // a corner of negligible mass that comes free
  CHECK(seen.leaves < 0.03);
  CHECK(seen.energy < 1e-3 * kModulus * 0.05 * 0.05 * 0.05);
  // Where sides are nearly flush, opposite corrections hold the blocks together.
  if (wider > 0.0) CHECK(seen.crossed == 0);
}

TEST_CASE("blocks with flush sides of which one is half inside the other are apart in the end", "[.missed]") {
  CHECK(overlapByHalf(0.0, 20.0).crossed == 0);
}

TEST_CASE("blocks that lie on each other on a slippery floor come to rest") {
  Simulator simulator;
  setGravity(simulator, 5.0);
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.0));
  for (int k = 0; k < 2; ++k) {
    const Vec3 low(0.002 * k, 0.0001 + k * 0.0501, 0.0);
    simulator.addBody(block(low, low + Vec3::Constant(0.05), 0.0125, soft(3e5, 0.3), 6));
  }
  while (simulator.time() < 3.0) REQUIRE(simulator.step());
  double fastest = 0.0;
  while (simulator.time() < 5.0) {
    REQUIRE(simulator.step());
    fastest = std::max(fastest, fastestOf(simulator));
  }
  CAPTURE(fastest);
  CHECK(fastest < 3e-3);  // m/s; driven by the residual of the impulse sweeps
}

// The stack of test_body_contact, for longer.
TEST_CASE("a stack of five blocks stays where it is for a minute", "[.long]") {
  Simulator simulator;
  const std::vector<std::size_t> ids = stackOfFive(simulator);
  while (simulator.time() < 2.0) REQUIRE(simulator.step());
  const std::vector<Vec3> then = meanDisplacements(simulator, ids);
  while (simulator.time() < 62.0) REQUIRE(simulator.step());
  double drift = 0.0;
  for (std::size_t k = 0; k < ids.size(); ++k)
    drift = std::max(drift, (shapes::meanDisplacement(*simulator.body(ids[k])) - then[k]).norm());
  CAPTURE(drift);
  CHECK(drift < 1e-4);
  CHECK(crossingsOfAll(simulator) == 0);
}
