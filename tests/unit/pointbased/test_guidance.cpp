// SPDX-License-Identifier: Apache-2.0
// Obstacles that a user guides, instruments that are added and removed, and the pressure of contact.
#include <numbers>
#include <numeric>

#include "contact_cases.h"
#include "pointbased/probe_tool.h"
#include "shapes.h"
#include "support/catch.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kE = 1e4;  // Pa

// A block of 40 × 20 × 40 mm that is fixed at its base.
std::unique_ptr<Body> heldBlock() {
  return block(Vec3(-0.02, 0, -0.02), Vec3(0.02, 0.02, 0.02), 0.005, soft(kE, 0.3, 5.0), 16,
               {{.region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitY()}}});
}

Obstacle ballAt(const Vec3 &at, double radius = 0.008, const std::string &name = "finger") {
  return *obstacleOf({name, radius, 0.0, 0.3, {{0.0, at}, {1.0, at}}});
}

Obstacle wall(const std::string &name, double height) {
  Obstacle out;
  out.name = name;
  out.closest = [height](std::span<const Vec3> points, std::span<const double> ranges,
                         std::span<SurfacePoint> answers) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = points[i][1] - height;
      answers[i] = distance <= ranges[i] ? SurfacePoint{Vec3::UnitY(), distance} : SurfacePoint();
    }
  };
  return out;
}

RigidMotion shifted(const Vec3 &way) { return {Mat3::Identity(), Vec3::Zero(), way}; }

void run(Simulator &simulator, double until) {
  while (simulator.time() < until) {
    const auto stepped = simulator.step();
    if (!stepped) FAIL(stepped.error().text);
  }
}

Vec3 forceOn(const Simulator &simulator, std::size_t obstacle) {
  Vec3 force = Vec3::Zero();
  for (const ContactSummary &c : simulator.diagnostics().contacts())
    if (c.second == obstacle) force -= c.force;
  return force;
}

}  // namespace

TEST_CASE("a hand leads an obstacle evenly, by the shorter turn, and reset gives it back its own motion") {
  Simulator simulator;
  simulator.addBody(heldBlock());
  Obstacle moving = ballAt(Vec3(0, 1, 0));
  moving.motion = [](double t) { return shifted(Vec3(0.1 * t, 0, 0)); };
  const std::size_t id = simulator.addObstacle(moving);
  run(simulator, 0.1);
  const double begin = simulator.time();
  const Vec3 from = simulator.world().obstacleMotion(id).displacementOf(Vec3(0, 1, 0));
  const RigidMotion target{Eigen::AngleAxisd(1.0, Vec3::UnitZ()).toRotationMatrix(), Vec3(0, 1, 0), Vec3(0, 0, 0.05)};
  simulator.world().guideObstacle(id, target, 0.2);
  CHECK(simulator.world().isGuided(id));
  const auto motion = simulator.world().obstacle(id)->motion;
  CHECK_THAT((motion(begin).displacementOf(Vec3(0, 1, 0)) - from).norm(), WithinAbs(0.0, 1e-12));
  const RigidMotion half = motion(begin + 0.1);
  CHECK_THAT((half.displacementOf(Vec3(0, 1, 0)) - 0.5 * (from + target.displacement)).norm(), WithinAbs(0.0, 1e-12));
  CHECK_THAT(Eigen::AngleAxisd(half.rotation).angle(), WithinAbs(0.5, 1e-12));
  run(simulator, begin + 0.3);
  const RigidMotion there = simulator.world().obstacleMotion(id);
  CHECK((there.rotation - target.rotation).norm() < 1e-12);
  CHECK_THAT((there.displacementOf(Vec3(0, 1, 0)) - target.displacement).norm(), WithinAbs(0.0, 1e-12));
  simulator.reset();
  CHECK_FALSE(simulator.world().isGuided(id));
  CHECK_THAT(simulator.world().obstacle(id)->motion(1.0).displacementOf(Vec3::Zero())[0], WithinAbs(0.1, 1e-15));
}

TEST_CASE("what is placed before the first step begins there, also after a reset") {
  Simulator simulator;
  simulator.addBody(heldBlock());
  const std::size_t id = simulator.addObstacle(ballAt(Vec3(0, 1, 0)));
  // The path of a probe tool is its own motion; a plate has none.
  const std::size_t plate = simulator.addObstacle(wall("plate", -1.0));
  simulator.world().guideObstacle(plate, shifted(Vec3(0, -0.5, 0)), 1.0);
  simulator.world().guideObstacle(plate, shifted(Vec3(0, -0.25, 0)), 1.0);
  CHECK(simulator.world().obstacleMotion(plate).displacement == Vec3(0, -0.25, 0));
  run(simulator, 0.05);
  simulator.world().guideObstacle(plate, shifted(Vec3(0, -0.125, 0)), 0.01);
  simulator.world().guideObstacle(id, shifted(Vec3(0, 1, 0)), 0.0);
  run(simulator, 0.1);
  CHECK(simulator.world().obstacleMotion(plate).displacement == Vec3(0, -0.125, 0));
  CHECK(simulator.world().motionAtReset(plate)(0.3).displacement == Vec3(0, -0.25, 0));
  simulator.reset();
  CHECK(simulator.world().obstacleMotion(plate).displacement == Vec3(0, -0.25, 0));
  CHECK(simulator.world().obstacleMotion(id).displacementOf(Vec3::Zero()).norm() == 0.0);
  simulator.world().guideObstacle(77, RigidMotion{}, 0.0);  // no such obstacle
  CHECK_FALSE(simulator.world().motionAtReset(77));
}

TEST_CASE("an instrument presses, is undone and done again, and goes with a reset") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(heldBlock());
  simulator.addObstacle(wall("table", 0.0));
  run(simulator, 0.05);
  const std::uint64_t course = simulator.archive().historyEpoch();
  const Checkpoint before = simulator.archive().checkpoint();
  const std::uint64_t hashBefore = simulator.stateHash();

  const std::size_t finger = simulator.world().addInstrument(ballAt(Vec3(0, 0.0281, 0)));
  CHECK(simulator.world().isInstrument(finger));
  simulator.world().guideObstacle(finger, shifted(Vec3(0, -0.004, 0)), 0.1);
  run(simulator, 0.3);
  const Vec3 pressed = forceOn(simulator, finger);
  CHECK(pressed[1] > 0.05);
  CHECK(std::hypot(pressed[0], pressed[2]) < 0.02 * pressed[1]);
  const Checkpoint after = simulator.archive().checkpoint();
  const std::uint64_t hashAfter = simulator.stateHash();

  REQUIRE(simulator.archive().restore(before));
  CHECK(simulator.world().obstacle(finger) == nullptr);
  CHECK(simulator.stateHash() == hashBefore);
  run(simulator, simulator.time() + 0.1);
  REQUIRE(simulator.archive().restore(after));
  REQUIRE(simulator.world().obstacle(finger) != nullptr);
  CHECK(simulator.world().isInstrument(finger));
  CHECK(simulator.stateHash() == hashAfter);
  run(simulator, simulator.time() + 0.02);
  CHECK_THAT(forceOn(simulator, finger)[1], WithinRel(pressed[1], 0.01));

  // Removed: the tissue recovers, and the simulated history is unchanged.
  REQUIRE(simulator.removeObstacle(finger));
  CHECK(simulator.archive().historyEpoch() == course);
  run(simulator, simulator.time() + 1.0);
  CHECK(largest(simulator.body(id)->state().displacements) < 1e-5);

  const std::size_t second = simulator.world().addInstrument(ballAt(Vec3(0, 0.5, 0)));
  simulator.reset();
  CHECK(simulator.world().obstacle(second) == nullptr);
  CHECK(simulator.world().obstacles().size() == 1);
}

TEST_CASE("a state with a moving instrument is loaded with that instrument only") {
  Simulator simulator;
  simulator.addBody(heldBlock());
  simulator.addObstacle(wall("table", 0.0));
  run(simulator, 0.05);
  const std::size_t finger = simulator.world().addInstrument(ballAt(Vec3(0, 0.0281, 0)));
  simulator.addObstacle(wall("plate", -1.0));
  simulator.world().guideObstacle(finger, shifted(Vec3(0, -0.004, 0)), 0.1);
  run(simulator, 0.1);
  const auto saved = simulator.archive().save();
  REQUIRE(saved);
  run(simulator, 0.2);
  const std::uint64_t hash = simulator.stateHash();
  CHECK_FALSE(simulator.archive().load(*saved));
  CHECK_FALSE(simulator.archive().load(*saved, {ballAt(Vec3::Zero()), ballAt(Vec3::Zero())}));
  CHECK(simulator.stateHash() == hash);
  const auto loaded = simulator.archive().load(*saved, {ballAt(Vec3(0, 0.0281, 0))});
  REQUIRE(loaded);
  REQUIRE(loaded->size() == 1);
  CHECK(simulator.world().isInstrument(loaded->front()));
  CHECK(simulator.world().isGuided(loaded->front()));
  CHECK(simulator.world().obstacles()[1].name == simulator.world().obstacle(loaded->front())->name);
  CHECK(simulator.archive().save().value() == *saved);
  run(simulator, 0.2);
  CHECK(simulator.stateHash() == hash);
}

TEST_CASE("what friction holds on another obstacle does not slip when an instrument comes and goes elsewhere") {
  const auto resting = [](bool visited) {
    Simulator simulator;
    simulator.setWorld({.gravity = 9.81 * Vec3(std::sin(0.2), -std::cos(0.2), 0),
                        .integrator = Integrator::implicitSdirk,
                        .sleep = false});
    const std::size_t id =
        simulator.addBody(block(Vec3(-0.02, 0, -0.02), Vec3(0.02, 0.02, 0.02), 0.01, soft(kE, 0.3, 5.0), 8));
    simulator.addObstacle(wall("table", 0.0));
    run(simulator, 0.5);
    const double t = simulator.time();
    if (visited) {
      const std::size_t far = simulator.world().addInstrument(ballAt(Vec3(1, 1, 1)));
      simulator.world().addInstrument(ballAt(Vec3(2, 1, 1)));
      run(simulator, t + 0.1);
      simulator.removeObstacle(far);
    }
    run(simulator, t + 0.2);
    return simulator.body(id)->state().displacements;
  };
  const auto plain = resting(false), visited = resting(true);
  double difference = 0.0;
  for (std::size_t i = 0; i < plain.size(); ++i) difference = std::max(difference, (plain[i] - visited[i]).norm());
  CHECK(difference < 1e-9);
}

TEST_CASE("what is attached to a guided obstacle follows it") {
  Simulator simulator;
  const std::size_t id =
      simulator.addBody(block(Vec3(-0.02, 0, -0.02), Vec3(0.02, 0.02, 0.02), 0.01, soft(kE, 0.3, 5.0), 8));
  simulator.setWorld({.damping = 5.0});
  const std::size_t plate = simulator.addObstacle(wall("plate", -0.001));
  REQUIRE(simulator.world().addAttachment(
      {.name = "glue", .first = id, .second = plate, .within = 0.002, .stiffness = 1e6, .tangential = 1e6}));
  run(simulator, 0.02);
  simulator.world().guideObstacle(plate, shifted(Vec3(0.01, 0, 0)), 0.1);
  run(simulator, 1.5);
  Vec3 mean = Vec3::Zero();
  for (const Vec3 &u : simulator.body(id)->state().displacements)
    mean += u / static_cast<double>(simulator.body(id)->rest().phyxelCount());
  CHECK_THAT(mean[0], WithinRel(0.01, 0.02));
}

TEST_CASE("contact pressure over the skin is the force that presses, on an obstacle and between bodies") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .damping = 5.0});
  const Material tissue = soft(5e4, 0.0, 20.0);
  const std::size_t below = simulator.addBody(block(Vec3(-0.02, 0, -0.02), Vec3(0.02, 0.02, 0.02), 0.01, tissue, 8));
  const std::size_t above =
      simulator.addBody(block(Vec3(-0.02, 0.0201, -0.02), Vec3(0.02, 0.0401, 0.02), 0.01, tissue, 8));
  const std::size_t table = simulator.addObstacle(wall("table", 0.0));
  run(simulator, 2.0);
  const double weight = 9.81 * simulator.body(above)->totalMass(), base = 0.04 * 0.04;

  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const ContactSummary *on = between(contacts, below, table), *joint = between(contacts, below, above);
  REQUIRE(on);
  REQUIRE(joint);
  CHECK_THAT(on->normalForce, WithinRel(2.0 * weight, 0.02));
  // Vertices at the edges also have faces on the sides.
  CHECK_THAT(on->area, WithinRel(base, 0.3));
  CHECK_THAT(joint->area, WithinRel(base, 0.3));

  std::vector<double> pressures;
  simulator.diagnostics().contactPressures(above, pressures);
  const RestState &rest = simulator.body(above)->rest();
  REQUIRE(pressures.size() == rest.phyxelCount());
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    const Vec3 &X = rest.positions[i];
    const bool isLow = rest.origin[1] + X[1] < 0.0201 + 1e-6;
    const bool isInner = isLow && std::max(std::abs(X[0] + rest.origin[0]), std::abs(X[2] + rest.origin[2])) < 0.011;
    CAPTURE(X.transpose());
    if (isInner)
      CHECK_THAT(pressures[i], WithinRel(weight / base, 0.15));  // few contacts: one vertex more or less
    else if (!isLow)
      CHECK(pressures[i] < 1e-9 * weight / base);  // round-off of the weights
  }
  std::vector<double> lower;
  simulator.diagnostics().contactPressures(below, lower);
  CHECK(*std::max_element(lower.begin(), lower.end()) > weight / base);
  simulator.diagnostics().contactPressures(12345, lower);
  CHECK(lower.empty());
}
