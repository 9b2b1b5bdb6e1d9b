// SPDX-License-Identifier: Apache-2.0
// Rigid bodies that move by their mass, alone and against others.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "body/rigid_frame.h"
#include "c3de/core/thread_pool.h"
#include "contact_cases.h"
#include "crossing_triangles.h"
#include "pointbased/attachment.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

Material metal() {
  Material material = soft(1e9, 0.3);
  material.restDensity = 4500.0;
  return material;
}

std::size_t addFree(Simulator &simulator, std::unique_ptr<Body> body) {
  body->setRigid(true, true);
  return simulator.addBody(std::move(body));
}

void weigh(Simulator &simulator, const Vec3 &gravity = Vec3(0, -9.81, 0), double damping = 0.0) {
  simulator.setWorld({.gravity = gravity, .damping = damping});
}

// m, largest change of a distance between phyxels.
double changeOfShape(const Body &body) {
  const std::vector<Vec3> &X = body.rest().positions, &u = body.state().displacements;
  double most = 0.0;
  for (std::size_t i = 0; i < X.size(); ++i)
    for (std::size_t j = 0; j < i; j += 7)
      most = std::max(most, std::abs((X[i] + u[i] - X[j] - u[j]).norm() - (X[i] - X[j]).norm()));
  return most;
}

// rad/s, about the body axis that is `axis` at rest.
double spinAbout(const Body &body, const Vec3 &axis) {
  const std::vector<Vec3> &X = body.rest().positions;
  const State &state = body.state();
  const Vec3 mean = meanVelocity(body), way = meanDisplacement(body);
  Vec3 centre = Vec3::Zero();
  for (const Vec3 &x : X) centre += x / static_cast<double>(X.size());
  // Of a field spin x r: Σ a·(r x v) / Σ |a x r|² along an axis a of symmetry.
  Vec3 along = Vec3::Zero();
  double moment = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < X.size(); ++i)
    along += (X[i] - centre).dot(axis) * (X[i] + state.displacements[i] - centre - way);
  along.normalize();
  for (std::size_t i = 0; i < X.size(); ++i) {
    const Vec3 r = X[i] + state.displacements[i] - centre - way;
    sum += along.dot(r.cross(state.velocities[i] - mean));
    moment += along.cross(r).squaredNorm();
  }
  return sum / moment;
}

// Checks that the total change of momentum in every step is that of weight and floor, relative to the weight's.
class Balance {
 public:
  explicit Balance(Simulator &simulator, std::size_t floor) : simulator_(simulator), floor_(floor) {}
  void step() {
    const Total before = totalOf(simulator_);
    const double from = simulator_.time();
    REQUIRE(simulator_.step());
    const double dt = simulator_.time() - from;
    Vec3 force = Vec3::Zero();
    double mass = 0.0;
    for (const std::size_t id : simulator_.bodyIds()) mass += simulator_.body(id)->totalMass();
    force += mass * simulator_.world().settings().gravity;
    for (const ContactSummary &one : simulator_.diagnostics().contacts())
      if (one.second == floor_) force += one.force;
    const Vec3 missed = totalOf(simulator_).momentum - before.momentum - dt * force;
    worst = std::max(worst, missed.norm() / (dt * mass * simulator_.world().settings().gravity.norm()));
  }
  double worst = 0.0;

 private:
  Simulator &simulator_;
  std::size_t floor_;
};

}  // namespace

TEST_CASE("a free rigid body falls as a stone and keeps its shape") {
  Simulator simulator;
  weigh(simulator);
  auto body = block(Vec3(0, 0, 0), Vec3(0.05, 0.03, 0.02), 0.01, metal(), 4);
  body->setInitialVelocity(Vec3(0.3, 2.0, 0), Vec3(3, 2, 1));
  const std::size_t id = addFree(simulator, std::move(body));
  REQUIRE(simulator.body(id)->isFreeRigid());
  const Total before = totalOf(simulator);
  while (simulator.time() < 2.0) REQUIRE(simulator.step());
  const double t = simulator.time();
  // The mean of the phyxels is the centre of the block. Verlet is exact in uniform gravity: rounding alone.
  const Vec3 way = meanDisplacement(*simulator.body(id));
  CHECK_THAT(way[0], WithinAbs(0.3 * t, 1e-11));
  CHECK_THAT(way[1], WithinAbs(2.0 * t - 0.5 * 9.81 * t * t, 1e-11));
  CHECK(changeOfShape(*simulator.body(id)) < 1e-14);  // of sums of 20 m
  CHECK_THAT(totalOf(simulator).energy, WithinRel(before.energy, 1e-11));
  CHECK(simulator.stepper().integratorOf(id) == Integrator::explicitVerlet);
}

TEST_CASE("a free rigid body that spins about its middle axis tumbles and keeps energy and angular momentum") {
  Simulator simulator;
  weigh(simulator, Vec3::Zero());
  auto body = block(Vec3(-0.06, -0.03, -0.015), Vec3(0.06, 0.03, 0.015), 0.01, metal(), 6);
  body->setInitialVelocity(Vec3::Zero(), Vec3(0.05, 20.0, 0.02));
  const std::size_t id = addFree(simulator, std::move(body));
  const Total before = totalOf(simulator);
  double energy = 0.0, angular = 0.0, least = 20.0, most = -20.0;
  while (simulator.time() < 20.0) {  // 64 turns
    REQUIRE(simulator.step());
    const Total now = totalOf(simulator);
    energy = std::max(energy, std::abs(now.energy / before.energy - 1.0));
    angular = std::max(angular, (now.angular - before.angular).norm() / before.angular.norm());
    const double spin = spinAbout(*simulator.body(id), Vec3::UnitY());
    least = std::min(least, spin);
    most = std::max(most, spin);
  }
  CAPTURE(1e12 * energy, 1e12 * angular, least, most, simulator.steps());
  // Exact but for rounding, of 1e-16 in each of some 1e4 substeps.
  CHECK(energy < 2e-12);
  CHECK(angular < 2e-12);
  CHECK(least < -19.0);
  CHECK(most > 19.0);
}

TEST_CASE("a free rigid block on a slope sticks below the angle of friction and slides above it as Coulomb says") {
  const double friction = 0.3;  // 16.7 degrees
  const auto slide = [&](double degrees, bool obstacle) {
    const double angle = degrees * std::numbers::pi / 180.0;
    Simulator simulator;
    weigh(simulator, 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0.0));
    simulator.world().setContact({true, false, friction});
    if (obstacle) {
      simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), friction));
    } else {
      auto table = block(Vec3(-0.1, -0.02, -0.04), Vec3(0.3, 0, 0.04), 0.01, metal(), 20);
      table->setRigid(true);
      simulator.addBody(std::move(table));
    }
    const std::size_t id =
        addFree(simulator, block(Vec3(-0.06, 0.0003, -0.03), Vec3(0, 0.0203, 0.03), 0.01, metal(), 6));
    const auto at = [&](double time) {
      while (simulator.time() < time) REQUIRE(simulator.step());
      return std::array<double, 3>{simulator.time(), meanDisplacement(*simulator.body(id))[0],
                                   meanVelocity(*simulator.body(id))[0]};
    };
    const auto early = at(0.1), late = at(0.3);
    return std::array<double, 3>{(late[2] - early[2]) / (late[0] - early[0]), late[1] - early[1], late[2]};
  };
  for (const bool obstacle : {true, false}) {
    CAPTURE(obstacle);
    const auto stuck = slide(15.0, obstacle);
    CAPTURE(stuck[1], stuck[2]);
    CHECK(std::abs(stuck[1]) < 2e-5);
    CHECK(std::abs(stuck[2]) < 2e-4);
    const double angle = 20.0 * std::numbers::pi / 180.0;
    CHECK_THAT(slide(20.0, obstacle)[0], WithinRel(9.81 * (std::sin(angle) - friction * std::cos(angle)), 0.01));
  }
}

TEST_CASE("a free rigid bar that hits an edge with one end turns as its inertia says") {
  Simulator simulator;
  weigh(simulator, Vec3::Zero());
  simulator.addObstacle(solidBox(Vec3(0.06, -0.1, -0.1), Vec3(0.3, 0.0, 0.1), 0.0));
  const std::size_t id = addFree(simulator, block(Vec3(-0.1, 0.005, -0.01), Vec3(0.1, 0.025, 0.01), 0.01, metal(), 2));
  setVelocity(simulator, id, Vec3(0, -0.5, 0));
  const Body &bar = *simulator.body(id);
  // It rotates about the first row of its contact points that is over the obstacle, and stops there.
  double arm = 1.0, moment = 0.0;
  const RestState &rest = bar.rest();
  for (const Vec3 &X : rest.contact.binding.positions)
    if (const double x = rest.origin[0] + X[0]; x > 0.06 && rest.origin[1] + X[1] < 0.006) arm = std::min(arm, x);
  for (std::size_t i = 0; i < rest.phyxelCount(); ++i) {
    const Vec3 r = rest.origin + rest.positions[i] - Vec3(0, 0.015, 0);
    moment += bar.masses()[i] * (r[0] * r[0] + r[1] * r[1]);
  }
  const double m = bar.totalMass(), impulse = m * 0.5 / (1.0 + m * arm * arm / moment);
  while (simulator.time() < 0.015) REQUIRE(simulator.step());
  CAPTURE(arm, moment, m);
  // The residual of the sweeps, and the rotation since: 2e-3 rad.
  CHECK_THAT(meanVelocity(bar)[1], WithinRel(-0.5 + impulse / m, 0.01));
  CHECK_THAT(spinAbout(bar, Vec3::UnitZ()), WithinRel(impulse * arm / moment, 0.01));
}

TEST_CASE("a free rigid block that falls flat on a wall bounces with its restitution") {
  Simulator simulator;
  weigh(simulator, Vec3::Zero());
  Obstacle wall = halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.0);
  wall.restitution = 0.6;
  simulator.addObstacle(std::move(wall));
  const std::size_t id = addFree(simulator, block(Vec3(0, 0.01, 0), Vec3(0.04, 0.03, 0.03), 0.01, metal(), 4));
  setVelocity(simulator, id, Vec3(0.2, -1.0, 0));
  while (simulator.time() < 0.05) REQUIRE(simulator.step());
  // All points of a face arrive at once; sweeps leave 1e-4 of the speed at some of them.
  CHECK_THAT(meanVelocity(*simulator.body(id))[1], WithinRel(0.6, 1e-3));
  CHECK_THAT(meanVelocity(*simulator.body(id))[0], WithinRel(0.2, 1e-3));
}

TEST_CASE("a free rigid ball that falls on a soft block rests on it with its weight") {
  Simulator simulator;
  weigh(simulator, Vec3(0, -9.81, 0), 10.0);
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  const std::size_t bed =
      simulator.addBody(block(Vec3(-0.05, 0.0, -0.05), Vec3(0.05, 0.04, 0.05), 0.01, soft(4e4, 0.3, 20.0), 20));
  const std::size_t id = addFree(simulator, ball(Vec3(0.004, 0.075, 0.002), 0.02, 0.005, metal(), 48));
  const double begin = totalOf(simulator).energy;
  double most = begin;
  std::size_t crossed = 0;
  while (simulator.time() < 1.5) {  // it rocks from facet to facet at 1 mm/s until 1.25 s, then comes to rest
    if (simulator.time() < 0.2) {
      most = std::max(most, totalOf(simulator).energy);
      if (simulator.steps() % 16 == 0) crossed += crossings(simulator, bed, id);
    }
    REQUIRE(simulator.step());
  }
  CHECK(crossed == 0);
  CHECK(crossings(simulator, bed, id) == 0);
  CHECK(most <= begin + 1e-6 * std::abs(begin));
  CHECK(meanVelocity(*simulator.body(id)).norm() < 1e-3);
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const ContactSummary *found = between(contacts, bed, id);
  REQUIRE(found);
  CHECK_THAT(std::abs(found->force[1]), WithinRel(9.81 * simulator.body(id)->totalMass(), 0.02));
  CHECK(changeOfShape(*simulator.body(id)) < 1e-14);
}

TEST_CASE("the momentum of a free rigid ball and the soft block that it falls on is that of weight and floor") {
  Simulator simulator;
  weigh(simulator);
  simulator.world().setContact({true, false, 0.3});
  const std::size_t floor = simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  simulator.addBody(block(Vec3(-0.05, 0.0, -0.05), Vec3(0.05, 0.04, 0.05), 0.01, soft(4e4, 0.3), 8));
  addFree(simulator, ball(Vec3(0.004, 0.062, 0.002), 0.02, 0.005, metal(), 24));
  Balance balance(simulator, floor);
  while (simulator.time() < 0.2) balance.step();
  CHECK(balance.worst < 1e-9);  // impulses of an impact are 1e3 times the weight's
}

TEST_CASE("a free rigid plate between two soft blocks is carried by one and carries the other") {
  Simulator simulator;
  weigh(simulator, Vec3(0, -9.81, 0), 20.0);
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  const Material tissue = soft(5e4, 0.3, 20.0);
  const std::size_t low =
      simulator.addBody(block(Vec3(-0.04, 0.0001, -0.04), Vec3(0.04, 0.0401, 0.04), 0.01, tissue, 8));
  const std::size_t plate =
      addFree(simulator, block(Vec3(-0.05, 0.0405, -0.03), Vec3(0.05, 0.0455, 0.03), 0.005, metal(), 10));
  const std::size_t high =
      simulator.addBody(block(Vec3(-0.03, 0.046, -0.03), Vec3(0.03, 0.076, 0.03), 0.01, tissue, 6));
  while (simulator.time() < 1.0) REQUIRE(simulator.step());
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const double above = 9.81 * simulator.body(high)->totalMass(),
               all = above + 9.81 * simulator.body(plate)->totalMass();
  const ContactSummary *below = between(contacts, low, plate), *over = between(contacts, plate, high);
  REQUIRE(below);
  REQUIRE(over);
  CHECK_THAT(std::abs(below->force[1]), WithinRel(all, 0.02));
  CHECK_THAT(std::abs(over->force[1]), WithinRel(above, 0.02));
  CHECK(crossings(simulator, low, plate) == 0);
  CHECK(crossings(simulator, plate, high) == 0);
}

TEST_CASE("free rigid blocks stay stacked and press with what lies on them") {
  Simulator simulator;
  weigh(simulator);
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  const std::size_t a = addFree(simulator, block(Vec3(0, 0.0001, 0), Vec3(0.05, 0.0301, 0.05), 0.01, metal(), 5));
  const std::size_t b =
      addFree(simulator, block(Vec3(0.01, 0.0305, 0.005), Vec3(0.05, 0.0605, 0.045), 0.01, metal(), 4));
  while (simulator.time() < 1.0) REQUIRE(simulator.step());
  const Vec3 then = meanDisplacement(*simulator.body(b));
  while (simulator.time() < 3.0) REQUIRE(simulator.step());
  // A thousandth of the spacing in two seconds.
  CHECK((meanDisplacement(*simulator.body(b)) - then).norm() < 1e-5);
  const std::vector<ContactSummary> contacts = simulator.diagnostics().contacts();
  const ContactSummary *found = between(contacts, a, b);
  REQUIRE(found);
  CHECK_THAT(std::abs(found->force[1]), WithinRel(9.81 * simulator.body(b)->totalMass(), 0.02));
  CHECK(crossings(simulator, a, b) == 0);
}

TEST_CASE("a free rigid ball and a soft one that collide keep their momenta and gain no energy") {
  Simulator simulator;
  simulator.world().setContact({true, false, 0.3});
  const std::size_t a = addFree(simulator, ball(Vec3(-0.051, 0, 0), 0.05, 0.0125, metal(), 32));
  const std::size_t b = simulator.addBody(ball(Vec3(0.051, 0.01, 0), 0.05, 0.0125, soft(1e4, 0.3), 32));
  setVelocity(simulator, a, Vec3(0.1, 0, 0));
  setVelocity(simulator, b, Vec3(-0.3, 0, 0));
  const Collision seen = collide(simulator, a, b, 0.2, 8);
  CAPTURE(seen.energy, seen.angularError, seen.momentumError);
  CHECK(seen.momentumError < 1e-12);
  CHECK(seen.angularError < 1e-3);  // as for two soft ones: forces of a step act between the positions at its beginning
  CHECK(seen.energy < 1.001);
  CHECK(seen.crossings == 0);
  CHECK(meanVelocity(*simulator.body(b))[0] > 0.2);  // thrown back by a body 4.5 times as heavy
}

namespace {

void addPile(Simulator &simulator) {
  weigh(simulator);
  simulator.world().setContact({true, true, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  simulator.addBody(ball(Vec3(0, 0.051, 0), 0.05, 0.02, soft(2e4, 0.3), 10));
  addFree(simulator, ball(Vec3(0.01, 0.132, 0.003), 0.03, 0.01, metal(), 12));
  addFree(simulator, block(Vec3(0.06, 0.001, -0.02), Vec3(0.09, 0.031, 0.02), 0.01, metal(), 3));
}

}  // namespace

TEST_CASE("free rigid bodies have the same bits for any number of threads") {
  std::vector<std::uint64_t> hashes;
  for (const unsigned threads : {1u, 2u}) {
    c3de::ThreadPool pool(threads);
    Simulator simulator(shapes::loopsOf(pool));
    addPile(simulator);
    for (int k = 0; k < 150; ++k) REQUIRE(simulator.step());
    hashes.push_back(simulator.stateHash());
    CHECK(!simulator.diagnostics().contacts().empty());
  }
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("free rigid bodies go on from a checkpoint and from a saved state as they went on") {
  Simulator simulator;
  addPile(simulator);
  for (int k = 0; k < 80; ++k) REQUIRE(simulator.step());
  REQUIRE(!simulator.diagnostics().contacts().empty());
  const auto after = [&] {
    for (int k = 0; k < 60; ++k) REQUIRE(simulator.step());
    return simulator.stateHash();
  };
  const Checkpoint kept = simulator.archive().checkpoint();
  const std::uint64_t first = after();
  REQUIRE(simulator.archive().restore(kept));
  CHECK(after() == first);
  REQUIRE(simulator.archive().restore(kept));
  const auto saved = simulator.archive().save();
  REQUIRE(saved);
  const std::uint64_t second = after();
  REQUIRE(simulator.archive().load(*saved));
  CHECK(after() == second);
}

TEST_CASE("a free rigid body hangs on an elastic layer by its weight, and a hand carries it") {
  Simulator simulator;
  weigh(simulator, Vec3(0, -9.81, 0), 20.0);
  auto ceiling = block(Vec3(0, 0.033, 0), Vec3(0.04, 0.063, 0.04), 0.01, metal(), 4);
  ceiling->setRigid(true);
  const std::size_t above = simulator.addBody(std::move(ceiling));
  const std::size_t id = addFree(simulator, block(Vec3(0, 0, 0), Vec3(0.04, 0.03, 0.04), 0.01, metal(), 4));
  const auto added = simulator.world().addAttachment(
      {.name = "layer", .first = id, .second = above, .within = 0.0045, .stiffness = 1e6, .tangential = 1e6});
  REQUIRE(added);
  while (simulator.time() < 2.0) REQUIRE(simulator.step());
  const double weight = 9.81 * simulator.body(id)->totalMass();
  // Damped to 1e-8 of the initial value.
  CHECK_THAT(meanDisplacement(*simulator.body(id))[1], WithinRel(-weight / (1e6 * 0.04 * 0.04), 1e-3));
  REQUIRE(simulator.world().removeAttachment(*added));

  Grab grab;
  const RestState &rest = simulator.body(id)->rest();
  for (Index i = 0; i < rest.phyxelCount(); ++i)
    if (rest.origin[1] + rest.positions[i][1] > 0.0249) grab.phyxels.push_back(i);
  REQUIRE(!grab.phyxels.empty());
  grab.weights.assign(grab.phyxels.size(), 1.0 / static_cast<double>(grab.phyxels.size()));
  simulator.stepper().setGrab(id, grab);
  simulator.stepper().moveGrab(id, Vec3(0.1, 0.1, 0.02));
  while (simulator.time() < 4.0) REQUIRE(simulator.step());
  const auto status = simulator.stepper().grabStatus(id);
  REQUIRE(status);
  CHECK_THAT(status->force[1], WithinRel(weight, 0.01));
  CHECK((status->point - Vec3(0.1, 0.1, 0.02)).norm() < 0.02);
}

TEST_CASE("what touches a free rigid body takes explicit steps with it, and that is said") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = Integrator::implicitSdirk});
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  const std::size_t bed =
      simulator.addBody(block(Vec3(-0.03, 0.0, -0.03), Vec3(0.03, 0.03, 0.03), 0.015, soft(2e4, 0.3), 4));
  addFree(simulator, block(Vec3(-0.01, 0.031, -0.01), Vec3(0.01, 0.051, 0.01), 0.01, metal(), 2));
  for (int k = 0; k < 5; ++k) REQUIRE(simulator.step());
  CHECK(simulator.stepper().integratorOf(bed) == Integrator::explicitVerlet);
  CHECK(shapes::countEvents(simulator, "chosen", "rigid and moves freely, which") == 1);
}

TEST_CASE("a free rigid body stands where something is fixed of it and in a static solution") {
  Simulator simulator;
  const Fix foot{.region = HalfSpaceRegion{Vec3(0, 0.001, 0), Vec3(0, 1, 0)}};
  weigh(simulator);
  const std::size_t held = addFree(simulator, block(Vec3(0, 0, 0), Vec3(0.03, 0.03, 0.03), 0.01, metal(), 3, {foot}));
  const std::size_t loose = addFree(simulator, block(Vec3(0.1, 0, 0), Vec3(0.13, 0.03, 0.03), 0.01, metal(), 3));
  CHECK(simulator.body(held)->isStatic());
  CHECK(simulator.body(loose)->isFreeRigid());
  for (int k = 0; k < 10; ++k) REQUIRE(simulator.step());
  CHECK(meanDisplacement(*simulator.body(held)).norm() == 0.0);
  CHECK(meanDisplacement(*simulator.body(loose))[1] < -0.01);
  WorldSettings world = simulator.world().settings();
  world.integrator = Integrator::quasiStatic;
  simulator.setWorld(world);
  CHECK(simulator.body(loose)->isStatic());
}

TEST_CASE("a free rigid body sleeps where it rests and wakes when something falls on it") {
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .sleep = true});
  simulator.world().setContact({true, false, 0.3});
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3(0, 1, 0), 0.5));
  const std::size_t a = addFree(simulator, block(Vec3(0, 0.001, 0), Vec3(0.05, 0.031, 0.05), 0.01, metal(), 5));
  while (simulator.time() < 3.0 && !simulator.stepper().asleep(a)) REQUIRE(simulator.step());
  REQUIRE(simulator.stepper().asleep(a));
  const std::size_t b = addFree(simulator, block(Vec3(0.01, 0.04, 0.01), Vec3(0.03, 0.06, 0.03), 0.01, metal(), 2));
  for (int k = 0; k < 20; ++k) REQUIRE(simulator.step());
  CHECK(meanDisplacement(*simulator.body(b))[1] > -0.0101);  // it rests on it
  CHECK(between(simulator.diagnostics().contacts(), a, b) != nullptr);
}

TEST_CASE("a rigid body whose phyxels lie in a plane or on a line has an inertia and keeps its spin") {
  for (const int width : {1, 4}) {
    CAPTURE(width);
    std::vector<Vec3> places, ways, velocities;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < width; ++j) places.emplace_back(0.01 * i, 0.01 * j, 0.0);
    ways.assign(places.size(), Vec3::Zero());
    velocities.resize(places.size());
    const std::vector<double> masses(places.size(), 1e-3);
    const detail::RigidFrame frame(places, masses, 0.01);
    detail::RigidPose pose = frame.poseOf(places, ways, masses);
    // About a line no spin is defined.
    const Vec3 spin(width == 1 ? 0.0 : 3.0, 2.0, 1.0);
    detail::RigidVelocity motion{Vec3(1, 2, 3), spin};
    frame.move(pose, motion, places, velocities);
    motion = frame.velocityOf(pose, places, velocities, masses);
    CHECK((motion.velocity - Vec3(1, 2, 3)).norm() < 1e-13);
    CHECK((motion.spin - spin).norm() < 1e-13);
    frame.advance(0.01, pose, motion);
    frame.place(pose, places, ways);
    const Mat3 off = frame.poseOf(places, ways, masses).rotation - pose.rotation;
    CHECK((width == 1 ? off.col(0).norm() : off.norm()) < 1e-13);
    // A cube of 10 mm as wide as the plane is thin: finite, and no less than the mass itself.
    CHECK(frame.changeBy(pose, Vec3::Zero(), Vec3(1, 1, 1)).spin.allFinite());
    CHECK(frame.largestInverseMassAt(pose, Vec3(0.02, 0, 0)) > 1.0 / frame.mass());
    const detail::RigidParticles four = frame.particles(pose, 0);
    CHECK((four.arms[0] + four.arms[1] + four.arms[2] + four.arms[3]).norm() < 1e-15);
  }
}
