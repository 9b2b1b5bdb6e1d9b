// SPDX-License-Identifier: Apache-2.0
// Bodies at rest, and contact points that are skipped.
#include <cmath>

#include "contact_cases.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

const Vec3 kDown(0, -9.81, 0);
constexpr double kSpacing = 0.02;  // m

WorldSettings restful(bool sleep, Integrator integrator = Integrator::explicitVerlet) {
  WorldSettings world{.gravity = kDown, .integrator = integrator, .damping = 15.0, .sleep = sleep};
  if (integrator != Integrator::explicitVerlet) world.dt = 1.0 / 60.0;
  return world;
}

std::unique_ptr<Body> block() {
  return latticeBox(Vec3(-0.04, 0.001, -0.04), Vec3(0.04, 0.061, 0.04), kSpacing, rubber(2e4, 20.0), 6);
}

struct OneBodyWorld {
  Simulator simulator;
  std::size_t id = 0;

  explicit OneBodyWorld(const WorldSettings &settings) {
    simulator.setWorld(settings);
    id = simulator.addBody(block());
    simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.5));
  }
  void runTo(double time) {
    while (simulator.time() < time) REQUIRE(simulator.step());
  }
  // @return s when it fell asleep; inf: not before `latest`
  double fallAsleep(double latest) {
    while (!simulator.stepper().asleep(id)) {
      if (simulator.time() > latest) return std::numeric_limits<double>::infinity();
      REQUIRE(simulator.step());
    }
    return simulator.time();
  }
  std::size_t evaluations() const {
    for (const StageClock::Summary &stage : simulator.diagnostics().stageTimes())
      if (stage.name == "internal_forces") return stage.calls;
    return 0;
  }
};

Grab handOn(const Body &body, const Vec3 &pull) {
  Grab grab{.phyxels = {0}};
  for (std::size_t i = 1; i < body.rest().phyxelCount(); ++i)
    if (body.rest().positions[i][1] > body.rest().positions[grab.phyxels[0]][1]) grab.phyxels = {static_cast<Index>(i)};
  grab.weights = {1.0};
  const Index i = grab.phyxels[0];
  grab.target = body.rest().origin + body.rest().positions[i] + body.state().displacements[i] + pull;
  grab.maxForce = 2.0;
  return grab;
}

double farthest(const Body &a, const Body &b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.state().displacements.size(); ++i)
    most = std::max(most, (a.state().displacements[i] - b.state().displacements[i]).norm());
  return most;
}

}  // namespace

TEST_CASE("A body that has come to rest in contact costs no evaluation of forces and stays where it is, bit for bit") {
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    OneBodyWorld world(restful(true, integrator));
    const double since = world.fallAsleep(6.0);
    REQUIRE(since < 6.0);
    CHECK(since > 0.5);
    const std::uint64_t hash = world.simulator.stateHash(), changes = world.simulator.stepper().changes(world.id);
    const std::size_t evaluations = world.evaluations(), steps = world.simulator.steps();
    world.runTo(since + 2.0);
    CHECK(world.simulator.stepper().asleep(world.id));
    CHECK(world.simulator.stateHash() == hash);
    CHECK(world.simulator.stepper().changes(world.id) == changes);
    CHECK(world.evaluations() == evaluations);
    CHECK(world.simulator.steps() > steps);
    // A body that never sleeps moves within the tolerance: 1e-4 of the spacing during the observed time.
    OneBodyWorld awake(restful(false, integrator));
    awake.runTo(since + 2.0);
    CHECK_FALSE(awake.simulator.stepper().asleep(awake.id));
    CHECK(farthest(*world.simulator.body(world.id), *awake.simulator.body(awake.id)) < 5e-4 * kSpacing);
  }
}

TEST_CASE("A hand wakes a body, which then moves as one that never slept") {
  OneBodyWorld world(restful(true)), awake(restful(false));
  const double since = world.fallAsleep(6.0);
  REQUIRE(since < 6.0);
  const double until = since + 1.0;
  for (OneBodyWorld *one : {&world, &awake}) one->runTo(until);
  REQUIRE(world.simulator.stepper().asleep(world.id));
  const Grab grab = handOn(*awake.simulator.body(awake.id), Vec3(0.004, 0.01, 0.0));
  double apart = 0.0, moved = 0.0;
  for (OneBodyWorld *one : {&world, &awake}) one->simulator.stepper().setGrab(one->id, grab);
  const std::vector<Vec3> before = awake.simulator.body(awake.id)->state().displacements;
  for (int i = 0; i < 600; ++i) {
    for (OneBodyWorld *one : {&world, &awake}) REQUIRE(one->simulator.step());
    CHECK_FALSE(world.simulator.stepper().asleep(world.id));
    apart = std::max(apart, farthest(*world.simulator.body(world.id), *awake.simulator.body(awake.id)));
    for (std::size_t p = 0; p < before.size(); ++p)
      moved = std::max(moved, (awake.simulator.body(awake.id)->state().displacements[p] - before[p]).norm());
  }
  CHECK(moved > 5e-4);
  CHECK(apart < 1e-3 * moved);
  for (OneBodyWorld *one : {&world, &awake}) one->simulator.stepper().releaseGrab(one->id);
  CHECK(world.fallAsleep(world.simulator.time() + 6.0) < 1e9);
}

TEST_CASE("Whatever changes around a sleeping body wakes it") {
  OneBodyWorld world(restful(true));
  REQUIRE(world.fallAsleep(6.0) < 6.0);
  const auto wakes = [&](const char *what, const std::function<void()> &change) {
    CAPTURE(what);
    REQUIRE(world.fallAsleep(world.simulator.time() + 6.0) < 1e9);
    change();
    REQUIRE(world.simulator.step());
    CHECK_FALSE(world.simulator.stepper().asleep(world.id));
  };
  wakes("gravity", [&] {
    WorldSettings settings = restful(true);
    settings.gravity = 0.5 * kDown;
    world.simulator.setWorld(settings);
  });
  wakes("material", [&] {
    world.simulator.world().setConstitution(world.id, Constitution{{rubber(1e4, 20.0)}, kLatticeStabilisation});
  });
  wakes("obstacle", [&] { world.simulator.addObstacle(halfSpace(Vec3(0, -0.5, 0), Vec3::UnitY(), 0.5)); });
  wakes("push", [&] { world.simulator.body(world.id)->state().velocities[0] = Vec3(0.1, 0, 0); });
  wakes("settings", [&] { world.simulator.setWorld(restful(false)); });
  for (int i = 0; i < 200; ++i) REQUIRE(world.simulator.step());
  world.runTo(world.simulator.time() + 2.0);
  CHECK_FALSE(world.simulator.stepper().asleep(world.id));  // no more
  world.simulator.reset();
  CHECK_FALSE(world.simulator.stepper().asleep(world.id));
}

TEST_CASE("A state that is set from outside wakes a body and counts as a change") {
  OneBodyWorld world(restful(true));
  REQUIRE(world.fallAsleep(6.0) < 6.0);
  Stepper &stepper = world.simulator.stepper();
  const std::uint64_t changes = stepper.changes(world.id);
  world.simulator.body(world.id)->state().displacements[0] += Vec3(0.0, 1e-3, 0.0);
  stepper.wake(world.id);
  CHECK(stepper.changes(world.id) > changes);
  CHECK_FALSE(stepper.asleep(world.id));
}

TEST_CASE("An obstacle that begins to move wakes a body, and carries it") {
  OneBodyWorld world(restful(true));
  Obstacle lift = solidBox(Vec3(-0.2, -0.3, -0.2), Vec3(0.2, -0.001, 0.2), 0.5);
  lift.motion = [](double t) {
    return RigidMotion{.displacement = Vec3(0.0, 0.03 * std::clamp(t - 6.0, 0.0, 1.0), 0.0)};
  };
  world.simulator.addObstacle(lift);
  REQUIRE(world.fallAsleep(5.9) < 5.9);
  world.runTo(5.99);
  CHECK(world.simulator.stepper().asleep(world.id));
  world.runTo(6.05);
  CHECK_FALSE(world.simulator.stepper().asleep(world.id));
  world.runTo(7.0);
  CHECK(extent(*world.simulator.body(world.id), Vec3::UnitY()).low > 0.028);
  CHECK(world.fallAsleep(12.0) < 12.0);
}

TEST_CASE("What moves, however little at the moment, does not sleep") {
  // Thrown upwards it is static for a moment; without gravity it drifts by a tenth of a millimetre in a second.
  WorldSettings settings = restful(true);
  settings.damping = 0.0;
  Simulator thrown;
  thrown.setWorld(settings);
  const std::size_t up = thrown.addBody(block());
  thrown.body(up)->setInitialVelocity(Vec3(0, 1.0, 0), Vec3::Zero());
  settings.gravity.setZero();
  Simulator drifting;
  drifting.setWorld(settings);
  const std::size_t slow = drifting.addBody(block());
  drifting.body(slow)->setInitialVelocity(Vec3(1e-4, 0, 0), Vec3::Zero());
  while (thrown.time() < 0.3) {
    REQUIRE(thrown.step());
    CHECK_FALSE(thrown.stepper().asleep(up));
  }
  while (drifting.time() < 1.5) {
    REQUIRE(drifting.step());
    REQUIRE_FALSE(drifting.stepper().asleep(slow));
  }
}

TEST_CASE("Points that wait have no contacts, and the others the same as if all were looked at") {
  // A tumbling body between a floor, walls and a rotating block.
  Simulator simulator;
  const WorldSettings settings{
      .gravity = kDown, .box = {true, Vec3(-0.15, -0.2, -0.15), Vec3(0.15, 0.5, 0.15), 0.3}, .dt = 2e-4};
  simulator.setWorld(settings);
  const std::size_t id = simulator.addBody(block());
  simulator.body(id)->setInitialVelocity(Vec3(0.8, 0.3, -0.4), Vec3(8.0, 3.0, -5.0));
  simulator.body(id)->reset();
  std::vector<Obstacle> obstacles{solidBox(Vec3(-0.1, -0.15, -0.05), Vec3(0.02, -0.05, 0.05), 0.3),
                                  halfSpace(Vec3(0, -0.18, 0), Vec3(0.2, 1, 0).normalized(), 0.2)};
  obstacles[0].motion = [](double t) {
    return RigidMotion{.rotation = Eigen::AngleAxisd(2.0 * t, Vec3(0.3, 1.0, 0.2).normalized()).toRotationMatrix(),
                       .centre = Vec3(-0.04, -0.1, 0.0),
                       .displacement = Vec3(0.05 * std::sin(3.0 * t), 0.0, 0.0)};
  };
  for (const Obstacle &obstacle : obstacles) simulator.addObstacle(obstacle);
  Body &body = *simulator.body(id);
  const RestState &rest = body.rest();
  ContactState all, some;
  std::size_t looked = 0, contacts = 0, searches = 0;
  const double margin = 0.02 * rest.spacing;
  while (simulator.time() < 0.6) {
    const double dt = simulator.stepper().stepSize();
    findContacts(obstacles, settings.box, simulator.time(), dt, margin, body.contactPositions(serialFor()),
                 body.contactVelocities(serialFor()), rest.contact.radii, all, serialFor());
    findContacts(obstacles, settings.box, simulator.time(), dt, margin,
                 {rest.contact, rest.origin, body.state().displacements, body.state().velocities}, some, serialFor());
    REQUIRE(some.active.size() == all.active.size());
    for (std::size_t c = 0; c < all.active.size(); ++c) {
      CHECK(some.active[c].point == all.active[c].point);
      CHECK(some.active[c].obstacle == all.active[c].obstacle);
      CHECK(some.active[c].normal == all.active[c].normal);
      CHECK(some.active[c].gap == all.active[c].gap);
    }
    contacts += all.active.size();
    looked += some.blocks.checkedPoints.size();
    ++searches;
    REQUIRE(simulator.step());
  }
  CHECK(contacts > 100);
  CHECK(4 * looked < 3 * searches * rest.contact.count());
}

TEST_CASE("A body in free flight asks for none of its points") {
  Simulator simulator;
  simulator.setWorld({.gravity = kDown});
  const std::size_t id = simulator.addBody(block());
  simulator.addObstacle(halfSpace(Vec3(0, -10.0, 0), Vec3::UnitY(), 0.3));
  REQUIRE(simulator.step());
  const ContactState &memory = simulator.body(id)->contact;
  CHECK(memory.blocks.checkedPoints.size() == simulator.body(id)->rest().contact.count());
  while (simulator.time() < 0.5) {
    REQUIRE(simulator.step());
    REQUIRE(memory.blocks.checkedPoints.empty());
  }
}
