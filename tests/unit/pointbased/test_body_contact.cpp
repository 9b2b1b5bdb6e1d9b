// SPDX-License-Identifier: Apache-2.0
// Contact of bodies with each other.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "c3de/core/thread_pool.h"
#include "contact_cases.h"
#include "crossing_triangles.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;
using Catch::Matchers::WithinRel;

namespace {

// One above the other, slightly offset, over a floor; with self-contact.
void addFallingBalls(Simulator &simulator, int count) {
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0)});
  simulator.world().setContact({true, true, 0.3});
  simulator.addObstacle(shapes::halfSpace(Vec3(0, 0, 0), Vec3(0, 1, 0), 0.5));
  for (int k = 0; k < count; ++k)
    simulator.addBody(ball(Vec3(0.01 * k, 0.051 + 0.101 * k, 0.003 * k), 0.05, 0.02, soft(2e4, 0.3), 10));
}

}  // namespace

TEST_CASE("two balls that collide keep their momenta, gain no energy and part") {
  Simulator simulator;
  const auto [a, b] = addCollidingBalls(simulator);
  const Total before = totalOf(simulator);
  const double scale = simulator.body(a)->totalMass() * 0.2;
  double most = 0.0, turned = 0.0;
  bool touched = false;
  while (simulator.time() < 0.2) {
    REQUIRE(simulator.step());
    const Total now = totalOf(simulator);
    most = std::max(most, now.energy);
    turned = std::max(turned, (now.angular - before.angular).norm());
    REQUIRE((now.momentum - before.momentum).norm() < 1e-12 * scale);
    const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
    if (const ContactSummary *one = between(contacts, a, b)) {
      touched = true;
      CHECK(one->force[0] < 0.0);  // on the left one, to the left
      CHECK(one->points > 0);
    }
  }
  CHECK(touched);
  const double turnedOf = turned / before.angular.norm(), left = totalOf(simulator).energy / before.energy;
  CAPTURE(turnedOf, left, most / before.energy);
  // As for velocity Verlet: (omega dt)²/8 of the oscillating modes.
  CHECK(most < 1.001 * before.energy);
  // Forces of a step act between the positions at its beginning.
  CHECK(turnedOf < 1e-3);
  // They separate; the loss is that of an impact (docs/theory/contact.md).
  CHECK(shapes::meanVelocity(*simulator.body(a))[0] < -0.15);
  CHECK(shapes::meanVelocity(*simulator.body(b))[0] > 0.15);
}

TEST_CASE("the skins of two balls that collide do not cross") {
  Simulator simulator;
  const auto [a, b] = addCollidingBalls(simulator);
  CHECK(collide(simulator, a, b, 0.2).crossings == 0);
}

TEST_CASE("a ball that meets its mirror image bounces as off a wall without friction") {
  const Material material = soft(1e4, 0.3);
  const auto speedAfter = [&](bool wall) {
    Simulator simulator;
    simulator.world().setContact({true, false, 0.0});
    const std::size_t a = simulator.addBody(ball(Vec3(-0.0505, 0, 0), 0.05, 0.0125, material, 32));
    setVelocity(simulator, a, Vec3(0.1, 0, 0));
    if (wall) {
      simulator.addObstacle(shapes::halfSpace(Vec3::Zero(), Vec3(-1, 0, 0), 0.0));
    } else {
      const std::size_t b = simulator.addBody(ball(Vec3(0.0505, 0, 0), 0.05, 0.0125, material, 32));
      setVelocity(simulator, b, Vec3(-0.1, 0, 0));
    }
    double contact = 0.0;
    while (simulator.time() < 0.3) {
      REQUIRE(simulator.step());
      if (!simulator.diagnostics().contacts().empty()) contact = simulator.time();
    }
    return std::pair(shapes::meanVelocity(*simulator.body(a))[0], contact);
  };
  const auto [offWall, lastOfWall] = speedAfter(true);
  const auto [offBall, lastOfBall] = speedAfter(false);
  CAPTURE(offWall, offBall, lastOfWall, lastOfBall);
  // Points of the skin meet faces of the other skin here, a plane there.
  CHECK_THAT(offBall, WithinRel(offWall, 0.02));
  CHECK_THAT(lastOfBall, WithinRel(lastOfWall, 0.05));
}

TEST_CASE("a block on an inclined block sticks below the angle of friction and slides above it as Coulomb says") {
  const double friction = 0.3;  // 16.7 degrees
  struct Seen {
    double way, speed;
  };
  const auto slide = [&](double degrees, const std::vector<double> &times) {
    const double angle = degrees * std::numbers::pi / 180.0;
    Simulator simulator;
    simulator.setWorld({.gravity = 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0.0)});
    const std::size_t id = addBlockOnBlock(simulator, friction, {0.01, 0.01}, 0.0001);
    std::vector<Seen> seen;
    for (const double time : times) {
      while (simulator.time() < time) REQUIRE(simulator.step());
      seen.push_back({shapes::meanDisplacement(*simulator.body(id))[0], shapes::meanVelocity(*simulator.body(id))[0]});
    }
    return seen;
  };
  const std::vector<Seen> stuck = slide(15.0, {0.1, 0.3});
  CAPTURE(stuck[0].way, stuck[1].way, stuck[1].speed);
  CHECK(std::abs(stuck[1].way - stuck[0].way) < 2e-5);
  CHECK(std::abs(stuck[1].speed) < 2e-4);
  const std::vector<Seen> sliding = slide(20.0, {0.1, 0.3});
  const double angle = 20.0 * std::numbers::pi / 180.0;
  CAPTURE(sliding[0].speed, sliding[1].speed);
  CHECK_THAT((sliding[1].speed - sliding[0].speed) / 0.2,
             WithinRel(9.81 * (std::sin(angle) - friction * std::cos(angle)), 0.01));
}

TEST_CASE("a stack of five blocks stays where it is and presses with what lies on it") {
  Simulator simulator;
  const std::vector<std::size_t> ids = stackOfFive(simulator);
  while (simulator.time() < 1.5) REQUIRE(simulator.step());
  const std::vector<Vec3> then = meanDisplacements(simulator, ids);
  while (simulator.time() < 4.0) REQUIRE(simulator.step());
  for (std::size_t k = 0; k < ids.size(); ++k)
    CHECK((shapes::meanDisplacement(*simulator.body(ids[k])) - then[k]).norm() < 1e-4);
  checkWeights(simulator, ids);
}

TEST_CASE("what has fallen asleep on another body still presses on it") {
  Simulator simulator;
  simulator.setWorld({.damping = 20.0, .sleep = true});
  const Fix floor{.region = HalfSpaceRegion{Vec3(0, 0, 0), Vec3(0, 1, 0)}};
  const Load load{.region = HalfSpaceRegion{Vec3(0, 0.0799, 0), Vec3(0, -1, 0)}, .force = Vec3(0, -0.1, 0)};
  const Material material = soft(2e4, 0.3);
  const std::size_t a = simulator.addBody(block(Vec3(0, 0, 0), Vec3::Constant(0.04), 0.01, material, 4, {floor}));
  const std::size_t b =
      simulator.addBody(block(Vec3(0, 0.04, 0), Vec3(0.04, 0.08, 0.04), 0.01, material, 4, {}, {load}));
  while (simulator.time() < 5.0 && !simulator.stepper().asleep(b)) REQUIRE(simulator.step());
  REQUIRE(simulator.stepper().asleep(b));
  for (int k = 0; k < 10; ++k) REQUIRE(simulator.step());
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const ContactSummary *found = between(contacts, a, b);
  REQUIRE(found);
  CHECK_THAT(found->normalForce, WithinRel(0.1, 0.01));
}

TEST_CASE("what overlaps at the start is said") {
  Simulator simulator;
  simulator.world().setContact({true, false, 0.0});
  const Material material = soft(1e4, 0.3);
  simulator.addBody(block(Vec3(0, 0, 0), Vec3::Constant(0.05), 0.01, material, 6));
  simulator.addBody(block(Vec3(0.047, 0.003, 0.002), Vec3(0.097, 0.053, 0.052), 0.01, material, 6));
  while (simulator.time() < 0.4) REQUIRE(simulator.step());
  CHECK(shapes::countEvents(simulator, "overlap", "removed at") > 0);
}

TEST_CASE("what overlaps at the start is led apart without a jolt") {
  Simulator simulator;
  simulator.world().setContact({true, false, 0.0});
  const Material material = soft(1e4, 0.3);
  const std::size_t a = simulator.addBody(block(Vec3(0, 0, 0), Vec3::Constant(0.05), 0.01, material, 6));
  const std::size_t b =
      simulator.addBody(block(Vec3(0.047, -0.012, -0.011), Vec3(0.097, 0.063, 0.062), 0.01, material, 10));
  double fastest = 0.0;
  while (simulator.time() < 1.5) {
    REQUIRE(simulator.step());
    for (const std::size_t id : {a, b}) fastest = std::max(fastest, largest(simulator.body(id)->state().velocities));
  }
  CHECK(fastest < 0.1);  // a corner of negligible mass; the blocks move at 3 mm/s
  CHECK(shapes::crossings(simulator, a, b) == 0);
  CHECK(shapes::countEvents(simulator, "overlap") > 0);
}

TEST_CASE("bodies that fit each other stay as they lie although their skins overlap, and press from there on") {
  for (const bool fits : {true, false}) {
    CAPTURE(fits);
    Simulator simulator;
    simulator.world().setContact({true, false, 0.0});
    const Material material = soft(1e4, 0.3);
    const std::size_t a = simulator.addBody(block(Vec3(0, 0, 0), Vec3::Constant(0.05), 0.01, material, 6));
    const std::size_t b =
        simulator.addBody(block(Vec3(0.049, -0.012, -0.011), Vec3(0.099, 0.063, 0.062), 0.01, material, 10));
    simulator.world().setContactPair(a, b, {.friction = 0.0, .enabled = true, .fits = fits});
    CHECK(simulator.world().contactPair(b, a).fits == fits);
    while (simulator.time() < 0.2) REQUIRE(simulator.step());
    double farthest = 0.0;
    for (const std::size_t id : {a, b})
      farthest = std::max(farthest, largest(simulator.body(id)->state().displacements));
    // Separated at 5 mm a second at most, else nothing acts.
    CHECK((fits ? farthest < 1e-12 : farthest > 1e-4));
    if (!fits) continue;
    // Each at 3 cm/s towards the other one: they separate again, and have not penetrated deeper than the layer yields.
    for (Vec3 &v : simulator.body(a)->state().velocities) v = Vec3(0.03, 0, 0);
    for (Vec3 &v : simulator.body(b)->state().velocities) v = Vec3(-0.03, 0, 0);
    double deepest = 0.0;
    while (simulator.time() < 0.4) {
      REQUIRE(simulator.step());
      for (const ContactSummary &contact : simulator.diagnostics().contacts())
        deepest = std::max(deepest, contact.depth);
    }
    CHECK(deepest < 0.02 * 0.01);
    CHECK(simulator.body(b)->state().velocities.front()[0] > simulator.body(a)->state().velocities.front()[0]);
  }
}

TEST_CASE("contact between bodies gives the same bits for any number of threads") {
  std::vector<std::uint64_t> hashes;
  for (const unsigned threads : {1u, 2u}) {
    c3de::ThreadPool pool(threads);
    Simulator simulator(shapes::loopsOf(pool));
    addFallingBalls(simulator, 3);
    for (int k = 0; k < 120; ++k) REQUIRE(simulator.step());
    hashes.push_back(simulator.stateHash());
    CHECK(!simulator.diagnostics().contacts().empty());
  }
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a pair that is switched off passes, and a body that stands still is touched") {
  for (const bool enabled : {true, false}) {
    Simulator simulator;
    simulator.setWorld({.gravity = Vec3(0, -9.81, 0)});
    simulator.world().setContact({true, true, 0.3});
    const std::size_t table =
        simulator.addBody(block(Vec3(-0.05, -0.03, -0.05), Vec3(0.05, 0, 0.05), 0.01, soft(1e5, 0.3), 8));
    simulator.world().setRigid(table, true);
    const std::size_t id =
        simulator.addBody(block(Vec3(-0.02, 0.001, -0.02), Vec3(0.02, 0.04, 0.02), 0.01, soft(2e4, 0.3), 4));
    simulator.world().setContactPair(table, id, {0.3, enabled});
    while (simulator.time() < 0.3) REQUIRE(simulator.step());
    const double low = shapes::extent(*simulator.body(id), Vec3(0, 1, 0)).low;
    if (enabled)
      CHECK(low > -2e-4);  // a fiftieth of the spacing: it has just fallen
    else
      CHECK(low < -0.1);
  }
}

TEST_CASE("contact goes on from a checkpoint as it went on") {
  Simulator simulator;
  addFallingBalls(simulator, 2);
  for (int k = 0; k < 80; ++k) REQUIRE(simulator.step());
  REQUIRE(!simulator.diagnostics().contacts().empty());
  const Checkpoint kept = simulator.archive().checkpoint();
  std::vector<std::uint64_t> hashes;
  for (const bool again : {false, true}) {
    if (again) REQUIRE(simulator.archive().restore(kept));
    for (int k = 0; k < 40; ++k) REQUIRE(simulator.step());
    hashes.push_back(simulator.stateHash());
  }
  CHECK(hashes[0] == hashes[1]);
}

namespace {

struct Extreme {
  const char *name;
  double modulus = 1e4, otherModulus = 1e4, spacing = 0.01, otherSpacing = 0.01, density = 1000.0, friction = 0.3,
         poisson = 0.3, speed = 0.3;
  bool edgeOnEdge = false;
};

void checkThatTheyMeet(const Extreme &extreme) {
  CAPTURE(extreme.name);
  Simulator simulator;
  simulator.world().setContact({true, true, extreme.friction});
  Material own = soft(extreme.modulus, extreme.poisson), other = soft(extreme.otherModulus, extreme.poisson);
  other.restDensity = extreme.density;
  const auto turned = [&](const Surface &surface, const Vec3 &centre, double angle, const Vec3 &axis) {
    Surface out = surface;
    for (Vec3 &x : out.positions) x = centre + Eigen::AngleAxisd(angle, axis) * x;
    return out;
  };
  const double half = 0.025, otherHalf = extreme.otherSpacing > 0.01 ? 0.1 : half;
  const Surface small = shapes::boxSurface(Vec3::Constant(-half), Vec3::Constant(half), 10);
  const Surface large = shapes::boxSurface(Vec3::Constant(-otherHalf), Vec3::Constant(otherHalf), 10);
  // Rotated by 45 degrees about perpendicular axes, so that an edge meets an edge.
  const double angle = extreme.edgeOnEdge ? std::numbers::pi / 4 : 0.0,
               reach = extreme.edgeOnEdge ? std::sqrt(2.0) : 1.0;
  const std::size_t a = simulator.addBody(bodyOf(
      shapes::inside(turned(small, Vec3(0, reach * half + 0.001, 0), angle, Vec3::UnitX())), extreme.spacing, own));
  const std::size_t b = simulator.addBody(
      bodyOf(shapes::inside(turned(large, Vec3(0.004, -reach * otherHalf, 0.003), angle, Vec3::UnitZ())),
             extreme.otherSpacing, other));
  setVelocity(simulator, a, Vec3(0.1 * extreme.speed, -extreme.speed, 0));
  setVelocity(simulator, b, Vec3(0, extreme.density > 1e4 ? 0.0 : extreme.speed, 0));
  const Total before = totalOf(simulator);
  double most = 0.0, way = 0.0;
  std::size_t crossed = 0;
  bool touched = false;
  const double end = 0.03 / extreme.speed;
  while (simulator.time() < end) {
    REQUIRE(simulator.step());
    const Total now = totalOf(simulator);
    most = std::max(most, now.energy);
    way = std::max(way, (now.momentum - before.momentum).norm());
    if (simulator.steps() % 8 == 0) crossed += shapes::crossings(simulator, a, b);
    touched = touched || between(simulator.diagnostics().contacts(), a, b) != nullptr;
  }
  CHECK(touched);
  CHECK(crossed == 0);
  CAPTURE(most / before.energy);
  CHECK(most < 1.005 * before.energy);
  CHECK(way < 1e-9 * simulator.body(b)->totalMass() * extreme.speed);
}

}  // namespace

TEST_CASE("whatever two blocks that meet are made of, they do not cross, gain no energy and keep their momentum") {
  checkThatTheyMeet(
      GENERATE(Extreme{.name = "stiffness 1 : 10000", .otherModulus = 1e8},
               Extreme{.name = "spacing 1 : 5", .otherSpacing = 0.05},
               Extreme{.name = "density 1 : 100", .density = 1e5}, Extreme{.name = "nu = 0.499", .poisson = 0.499},
               Extreme{.name = "no friction", .friction = 0.0}, Extreme{.name = "friction 2", .friction = 2.0},
               Extreme{.name = "5 m/s", .modulus = 1e5, .otherModulus = 1e5, .speed = 2.5}));
}

// Not met, with figures in docs/theory/cannot.md: tests tagged [.missed] state the requirement.
TEST_CASE("blocks that meet edge on edge do not cross", "[.missed]") {
  checkThatTheyMeet(Extreme{.name = "edge on edge", .edgeOnEdge = true});
}

TEST_CASE("a sheet one cell thick that falls on a ball drapes over it and crosses neither it nor itself", "[.missed]") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .damping = 3.0});
  simulator.world().setContact({true, true, 0.2});
  const std::size_t under = simulator.addBody(ball(Vec3(0, -0.041, 0), 0.04, 0.008, soft(1e5, 0.3), 40));
  simulator.world().setRigid(under, true);
  const std::size_t sheet =
      simulator.addBody(block(Vec3(-0.05, 0.0, -0.05), Vec3(0.05, 0.008, 0.05), 0.008, soft(2e4, 0.3), 24));
  std::size_t crossed = 0;
  while (simulator.time() < 0.3) {
    REQUIRE(simulator.step());
    if (simulator.steps() % 40 == 0)
      crossed += shapes::crossings(simulator, under, sheet) + shapes::crossings(simulator, sheet);
  }
  CHECK(crossed == 0);
  CHECK(between(simulator.diagnostics().contacts(), under, sheet) != nullptr);
  CHECK(shapes::extent(*simulator.body(sheet), Vec3(0, 1, 0)).low < -0.005);
}
