// SPDX-License-Identifier: Apache-2.0
// Reported contact forces, and settings of pairs.
#include <cmath>
#include <numbers>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

constexpr double kGravity = 9.81;  // m/s²

std::unique_ptr<Body> blockAt(double height) {
  return latticeBox(Vec3(-0.04, height, -0.04), Vec3(0.04, height + 0.04, 0.04), 0.02, rubber(5e4, 100.0));
}

}  // namespace

TEST_CASE("the weight of a block is the force that its ground is reported with") {
  const Integrator integrator =
      GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::implicitMidpoint,
               Integrator::backwardEuler, Integrator::quasiStatic);
  const bool onWall = GENERATE(false, true);
  CAPTURE(static_cast<int>(integrator), onWall);
  Simulator simulator;
  WorldSettings world = worldOf(integrator, Vec3(0, -kGravity, 0));
  if (integrator == Integrator::quasiStatic) world.loadSteps = 2;
  world.damping = integrator == Integrator::quasiStatic ? 0.0 : 10.0;
  world.box = {onWall, Vec3(-1, 0, -1), Vec3(1, 2, 1), 0.3, 0.0};
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(blockAt(0.0));
  std::size_t ground = kWorldBox;
  if (!onWall) ground = simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  CHECK(simulator.diagnostics().contacts().empty());
  if (integrator == Integrator::quasiStatic) {
    while (!simulator.finished()) REQUIRE(simulator.step());
  } else {
    while (simulator.time() < 0.5) REQUIRE(simulator.step());
    world.damping = 0.0;  // it would support a part of the weight
    simulator.setWorld(world);
    while (simulator.time() < 0.7) REQUIRE(simulator.step());
  }
  const auto contacts = simulator.diagnostics().contacts();
  REQUIRE(contacts.size() == 1);
  const ContactSummary &c = contacts.front();
  const double weight = kGravity * simulator.body(id)->totalMass();
  CHECK(c.first == id);
  CHECK(c.second == ground);
  CHECK_THAT(c.force[1], WithinRel(weight, 0.01));
  CHECK(std::hypot(c.force[0], c.force[2]) < 0.01 * weight);
  CHECK_THAT(c.normalForce, WithinRel(weight, 0.01));
  CHECK(c.points >= 16);
  // Explicit: the rattling within the margin. Else the penalty yields by p d / (30 E), about four times that at the
  // edges.
  const double even = weight / (0.08 * 0.08) * 0.02 / (30.0 * 5e4);
  CHECK(c.depth <= (integrator == Integrator::explicitVerlet ? 0.02 * 0.02 : 4.0 * even));
  if (integrator != Integrator::explicitVerlet) CHECK(c.depth >= even);
}

TEST_CASE("the forces of contact over an impact are the change of the momentum") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk,
                                         Integrator::implicitMidpoint, Integrator::backwardEuler);
  const double restitution = GENERATE(0.0, 0.7);
  CAPTURE(static_cast<int>(integrator), restitution);
  Simulator simulator;
  WorldSettings world = worldOf(integrator, Vec3::Zero());
  if (integrator != Integrator::explicitVerlet) world.dt = 1.0 / 480.0;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(blockAt(0.003));
  Obstacle ground = halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3);
  ground.restitution = restitution;
  simulator.addObstacle(std::move(ground));
  Body &body = *simulator.body(id);
  body.setInitialVelocity(Vec3(0.3, -1.0, 0), Vec3::Zero());
  body.reset();
  const double mass = body.totalMass();
  Vec3 impulse = Vec3::Zero();
  while (simulator.time() < 0.08) {
    const double from = simulator.time();
    REQUIRE(simulator.step());
    for (const ContactSummary &c : simulator.diagnostics().contacts()) {
      REQUIRE(std::hypot(c.force[0], c.force[2]) <= (0.3 + 1e-9) * c.normalForce);
      impulse += (simulator.time() - from) * c.force;
    }
  }
  const Vec3 gained = mass * (meanVelocity(body) - Vec3(0.3, -1.0, 0));
  CHECK(gained[1] > mass);  // it has rebounded
  // Implicit steps: friction is reported with the normal forces of the solution but computed with those of the previous
  // one (1 %).
  CHECK((impulse - gained).norm() < (integrator == Integrator::explicitVerlet ? 1e-9 : 0.01) * gained.norm());
}

TEST_CASE("friction of a pair is that of this body alone: it slides where another holds") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk);
  const bool onWall = GENERATE(false, true);
  CAPTURE(static_cast<int>(integrator), onWall);
  const double angle = 12.0 * std::numbers::pi / 180.0, mu = 0.05;  // atan(0.3) = 16.7 degrees
  Simulator simulator;
  WorldSettings world = worldOf(integrator, kGravity * Vec3(std::sin(angle), -std::cos(angle), 0));
  world.box = {onWall, Vec3(-5, 0, -5), Vec3(5, 2, 5), 0.3, 0.0};
  simulator.setWorld(world);
  simulator.world().setContact({false, false, 0.3});  // they overlap
  const std::size_t held = simulator.addBody(blockAt(0.0)), sliding = simulator.addBody(blockAt(0.0));
  std::size_t ground = kWorldBox;
  if (!onWall) ground = simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  CHECK(simulator.world().contactPair(ground, sliding).friction == 0.3);
  simulator.world().setContactPair(ground, sliding, {mu, true});
  CHECK(simulator.world().contactPair(sliding, ground).friction == mu);
  CHECK(simulator.world().contactPair(held, ground).friction == 0.3);
  // Between bodies nothing is set here, and this is a setting: it persists.
  simulator.reset();
  while (simulator.time() < 0.2) REQUIRE(simulator.step());
  const double from = simulator.time(), speed = meanVelocity(*simulator.body(sliding))[0];
  while (simulator.time() < 0.4) REQUIRE(simulator.step());
  const double rate = (meanVelocity(*simulator.body(sliding))[0] - speed) / (simulator.time() - from);
  CHECK_THAT(rate, WithinRel(kGravity * (std::sin(angle) - mu * std::cos(angle)), 0.01));
  CHECK(std::abs(meanVelocity(*simulator.body(held))[0]) < 1e-3);
  std::size_t told = 0;
  for (const ContactSummary &c : simulator.diagnostics().contacts()) {
    if (c.second != ground) continue;
    ++told;
    // Sliding is resisted by mu N, sticking by the weight along the slope.
    const double expected =
        c.first == sliding ? mu * c.normalForce : kGravity * std::sin(angle) * simulator.body(held)->totalMass();
    CHECK_THAT(-c.force[0], WithinRel(expected, 0.02));
  }
  CHECK(told == 2);
  simulator.world().setContactPair(ground, sliding, {-1.0, true});
  CHECK(simulator.world().contactPair(sliding, ground).friction == 0.3);
}

TEST_CASE("a body falls through what its pair switches off, another stays, and it is not pulled back afterwards") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk);
  const int kind = GENERATE(0, 1, 2);  // block, sheet, walls
  CAPTURE(static_cast<int>(integrator), kind);
  Simulator simulator;
  WorldSettings world = worldOf(integrator, Vec3(0, -kGravity, 0));
  world.box = {kind == 2, Vec3(-1, 0, -1), Vec3(1, 2, 1), 0.3, 0.0};
  simulator.setWorld(world);
  simulator.world().setContact({false, false, 0.3});  // they overlap
  const std::size_t stays = simulator.addBody(blockAt(0.001)), falls = simulator.addBody(blockAt(0.001));
  std::size_t ground = kWorldBox;
  if (kind == 0) ground = simulator.addObstacle(solidBox(Vec3(-0.5, -0.2, -0.5), Vec3(0.5, 0, 0.5), 0.3));
  if (kind == 1) ground = simulator.addObstacle(sheet(0.0, 0.5, 0.3));
  // It rests first, so that contact has complete data of the obstacle that it then falls through.
  while (simulator.time() < 0.1) REQUIRE(simulator.step());
  CHECK(extent(*simulator.body(falls), Vec3::UnitY()).low > -1e-4);
  const Checkpoint lying = simulator.archive().checkpoint();
  simulator.world().setContactPair(falls, ground, {0.3, false});
  CHECK_FALSE(simulator.world().contactPair(ground, falls).enabled);
  const double from = simulator.time();
  while (simulator.time() < 0.35) REQUIRE(simulator.step());
  const double fallen = simulator.time() - from;
  CHECK_THAT(extent(*simulator.body(falls), Vec3::UnitY()).high - 0.04,
             WithinRel(-0.5 * kGravity * fallen * fallen, 0.05));
  CHECK(extent(*simulator.body(stays), Vec3::UnitY()).low > -1e-4);
  for (const ContactSummary &c : simulator.diagnostics().contacts()) CHECK((c.first == stays || c.second != ground));
  if (kind != 2) {
    // On again: it is far below, and continues to fall.
    simulator.world().setContactPair(falls, ground, {0.3, true});
    const double speed = meanVelocity(*simulator.body(falls))[1], then = simulator.time();
    while (simulator.time() < then + 0.02) REQUIRE(simulator.step());
    CHECK_THAT(meanVelocity(*simulator.body(falls))[1] - speed, WithinRel(-kGravity * (simulator.time() - then), 0.05));
  }
  // An earlier state, with the current settings.
  simulator.world().setContactPair(falls, ground, {0.3, true});
  REQUIRE(simulator.archive().restore(lying));
  const double then = simulator.time();
  while (simulator.time() < then + 0.1) REQUIRE(simulator.step());
  CHECK(extent(*simulator.body(falls), Vec3::UnitY()).low > -1e-4);
}

TEST_CASE("settings of pairs go with who they are about, and those of nobody are not kept") {
  Simulator simulator;
  const std::size_t a = simulator.addBody(blockAt(0.0)), b = simulator.addBody(blockAt(0.1));
  const std::size_t ground = simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  const std::size_t plate = simulator.addObstacle(halfSpace(Vec3(0, -1, 0), Vec3::UnitY(), 0.2));
  simulator.world().setContact({true, false, 0.4});
  CHECK(simulator.world().contactPair(a, b) == ContactPairSettings{0.4, true});
  simulator.world().setContactPair(b, a, {0.1, true});
  CHECK(simulator.world().contactPair(a, b) == ContactPairSettings{0.1, true});
  simulator.world().setContact({false, false, 0.4});
  CHECK_FALSE(simulator.world().contactPair(a, b).enabled);
  CHECK(simulator.world().contactPair(a, ground).enabled);  // obstacles still act
  simulator.world().setContactPair(a, ground, {0.7, true});
  simulator.world().setContactPair(a, plate, {0.0, false});
  CHECK(simulator.world().obstaclesOf(a)[0].friction == 0.7);
  CHECK_FALSE(simulator.world().obstaclesOf(a)[1].closest);
  CHECK(simulator.world().obstaclesOf(b)[0].friction == 0.3);
  REQUIRE(simulator.removeObstacle(ground));
  REQUIRE(simulator.world().obstaclesOf(a).size() == 1);
  CHECK_FALSE(simulator.world().obstaclesOf(a)[0].closest);
  REQUIRE(simulator.removeObstacle(plate));
  CHECK(simulator.world().obstaclesOf(a).empty());
  CHECK_FALSE(simulator.world().contactPair(a, plate).enabled);
  // Two obstacles, one with itself, a body that does not exist.
  const std::size_t other = simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  for (const auto &[first, second] : {std::pair{other, kWorldBox}, {a, a}, {a, std::size_t{999}}}) {
    simulator.world().setContactPair(first, second, {0.1, true});
    CHECK_FALSE(simulator.world().contactPair(first, second).enabled);
  }
  CHECK(simulator.world().contact() == ContactSettings{false, false, 0.4});
}
