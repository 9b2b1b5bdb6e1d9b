// SPDX-License-Identifier: Apache-2.0
// Bodies with a skin against obstacles, as the user sees them.
#include <cmath>
#include <numbers>
#include <utility>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using namespace shapes;

namespace {

const Vec3 kDown(0, -9.81, 0);
// Indentation by the penalty under 60 mm of E = 20 kPa: rho g H d / (30 E) = 21 um where the pressure is uniform, less
// than four times that at the edges.
constexpr double kSunk = 84e-6;  // m

}  // namespace

TEST_CASE("a body does not pass a block, a thin sheet or a wall at 1, 10 and 100 m/s, and gains no energy", "[slow]") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk,
                                         Integrator::implicitMidpoint, Integrator::backwardEuler);
  const double speed = GENERATE(1.0, 10.0, 100.0);
  const int kind = GENERATE(0, 1, 2);
  CAPTURE(static_cast<int>(integrator), speed, kind);
  Simulator simulator;
  WorldSettings world = worldOf(integrator, Vec3::Zero());
  if (kind == 2) world.box = {.enabled = true, .min = Vec3(-5, 0, -5), .max = Vec3(5, 10, 5)};
  simulator.setWorld(world);
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0.0507, -0.03), Vec3(0.03, 0.1107, 0.03), 0.02, rubber(1e5)));
  if (kind == 0) simulator.addObstacle(solidBox(Vec3(-0.5, -0.2, -0.5), Vec3(0.5, 0, 0.5), 0.3));
  if (kind == 1) simulator.addObstacle(sheet(0.0, 0.5, 0.3));
  Body &body = *simulator.body(id);
  body.setInitialVelocity(Vec3(0, -speed, 0), Vec3::Zero());
  body.reset();
  const double before = totalEnergy(simulator, id);
  double most = 0.0, lowest = 1.0;
  while (simulator.time() < 0.1 / speed + 0.04) {
    REQUIRE(simulator.step());
    most = std::max(most, totalEnergy(simulator, id));
    lowest = std::min(lowest, extent(body, Vec3::UnitY()).low);
  }
  // Explicit: velocity Verlet moves the energy by up to (omega dt)²/4 of the energy of its fastest modes.
  CHECK(most <= before * (1.0 + (integrator == Integrator::explicitVerlet ? 0.01 : 1e-6)));
  // Explicit: the residual of the sweeps, a quarter of the margin of contact. Implicit: the penalty yields by rho H (v
  // / dt) d / (30 E) where the pressure is uniform; twice that at the edges, and twice that again in each step that had
  // to be halved: twice at 100 m/s, where the outcome depends on nanometres (150 starts: 18 mm at most).
  const double give = integrator == Integrator::explicitVerlet
                          ? 0.25 * 0.02 * 0.02
                          : (speed < 100.0 ? 4.0 : 8.0) * 1060.0 * 0.06 * speed / kImplicitStep * 0.02 / (30.0 * 1e5);
  CHECK(lowest > -give);
  CHECK(meanVelocity(body)[1] > -0.05 * speed);
}

TEST_CASE("a body comes to rest on the ground without jitter and then asks nobody") {
  const Integrator integrator =
      GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  WorldSettings world = worldOf(integrator, kDown);
  world.damping = 10.0;
  world.tolerance = 1e-9;  // m: with the usual 1e-5 spacings the noise of the solution is 1e-9 J
  simulator.setWorld(world);
  Asked asked;
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.04, 0.0007, -0.04), Vec3(0.04, 0.0607, 0.04), 0.02, rubber(2e4, 60.0)));
  simulator.addObstacle(solidBox(Vec3(-0.5, -0.2, -0.5), Vec3(0.5, 0, 0.5), 0.3, &asked));
  while (simulator.time() < 1.5) REQUIRE(simulator.step());
  asked = {};
  while (simulator.time() < 2.0) {
    REQUIRE(simulator.step());
    REQUIRE(simulator.diagnostics().energy(id).kinetic < 1e-10);
  }
  CHECK(asked.closest + asked.crossing == 0);
  CHECK(extent(*simulator.body(id), Vec3::UnitY()).low > -kSunk);
  CHECK(extent(*simulator.body(id), Vec3::UnitY()).low < 1e-6);
}

TEST_CASE("the impulses of the ground are the weight of what lies on it, and their torque is none") {
  Simulator simulator;
  WorldSettings world = worldOf(Integrator::explicitVerlet, kDown);
  world.damping = 10.0;
  simulator.setWorld(world);
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.04, 0.0001, -0.04), Vec3(0.04, 0.0601, 0.04), 0.02, rubber(2e4, 60.0)));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  while (simulator.time() < 1.5) REQUIRE(simulator.step());
  world.damping = 0.0;  // it would support a part of the weight
  simulator.setWorld(world);
  while (simulator.time() < 1.6) REQUIRE(simulator.step());
  const Body &body = *simulator.body(id);
  double impulse = 0.0;
  Vec3 torque = Vec3::Zero();
  for (const Contact &c : body.contact.active) {
    const Vec3 at = body.rest().origin + body.rest().contact.binding.positions[c.point];
    impulse += c.normalImpulse + c.projectionImpulse;
    torque += at.cross((c.normalImpulse + c.projectionImpulse) * c.normal);
  }
  double dt = 0.0;
  {
    const double t = simulator.time();
    REQUIRE(simulator.step());
    dt = simulator.time() - t;
  }
  // The step may be divided: the impulses are those of the last piece.
  const double pieces = std::round(dt * body.totalMass() * 9.81 / impulse);
  CHECK_THAT(impulse * pieces, WithinRel(body.totalMass() * 9.81 * dt, 1e-3));
  CHECK(torque.norm() < 1e-3 * 0.04 * impulse);  // about the middle of the box, by its symmetry
}

TEST_CASE("a block on a slope holds below the friction angle and slides above it with Coulomb's acceleration") {
  const Integrator integrator =
      GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler);
  const double mu = 0.3, angle_deg = GENERATE(15.0, 25.0);  // atan(0.3) = 16.7
  CAPTURE(static_cast<int>(integrator), angle_deg);
  const double angle = angle_deg * std::numbers::pi / 180.0;
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0)));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.04, 0, -0.04), Vec3(0.04, 0.04, 0.04), 0.02, rubber(5e4, 100.0)));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), mu));
  const Body &body = *simulator.body(id);
  while (simulator.time() < 0.3) REQUIRE(simulator.step());
  const double t = simulator.time(), speed = meanVelocity(body)[0], place = meanDisplacement(body)[0];
  while (simulator.time() < 0.6) REQUIRE(simulator.step());
  if (angle_deg < 16.7) {
    CHECK(std::abs(meanDisplacement(body)[0] - place) < 1e-6);  // it creeps no further
    CHECK(place < 1e-3);                                        // than the sag by shear
    return;
  }
  const double acceleration = (meanVelocity(body)[0] - speed) / (simulator.time() - t);
  CHECK_THAT(acceleration, WithinRel(9.81 * (std::sin(angle) - mu * std::cos(angle)), 2e-3));
}

TEST_CASE("a body that begins inside is led out without being thrown") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk,
                                         Integrator::implicitMidpoint, Integrator::backwardEuler);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, kDown));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.04, -0.01, -0.04), Vec3(0.04, 0.05, 0.04), 0.02, rubber(2e4, 20.0)));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  double highest = -1.0;
  while (simulator.time() < 1.0) {
    REQUIRE(simulator.step());
    highest = std::max(highest, extent(*simulator.body(id), Vec3::UnitY()).low);
  }
  // It separates at 0.1 m/s; its elastic rebound is 0.14 m/s at most, which lifts it by 1 mm; second order schemes
  // propagate the push of a stage, 2 mm.
  CHECK(highest < 2e-3);
  CHECK_THAT(extent(*simulator.body(id), Vec3::UnitY()).low, WithinAbs(0.0, kSunk));
}

TEST_CASE("a moving obstacle pushes a body before it") {
  const Integrator integrator =
      GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, Vec3::Zero()));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.04, -0.04, -0.04), Vec3(0.04, 0.04, 0.04), 0.02, rubber(5e4, 100.0)));
  Obstacle pusher = solidBox(Vec3(-0.2, -0.1, -0.1), Vec3(-0.05, 0.1, 0.1), 0.3);
  pusher.motion = [](double t) { return RigidMotion{.displacement = Vec3(0.2 * t, 0, 0)}; };
  simulator.addObstacle(pusher);
  Body &body = *simulator.body(id);
  while (simulator.time() < 1.0) {
    REQUIRE(simulator.step());
    // Nothing passes the face; implicit steps penetrate by the penalty.
    REQUIRE(extent(body, Vec3::UnitX()).low >
            -0.05 + 0.2 * simulator.time() - (simulator.world().settings().dt > 0.0 ? 1e-3 : 1e-5));
  }
  // Between a plastic and an elastic impact.
  CHECK(meanVelocity(body)[0] > 0.2 - 1e-3);
  CHECK(meanVelocity(body)[0] < 0.4);
  CHECK(std::abs(meanVelocity(body)[1]) < 1e-3);
}

TEST_CASE("a turntable carries a block by friction") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::backwardEuler);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, kDown));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(0.08, 0, -0.02), Vec3(0.12, 0.04, 0.02), 0.02, rubber(5e4, 100.0)));
  Obstacle table = solidBox(Vec3(-0.5, -0.1, -0.5), Vec3(0.5, 0, 0.5), 0.5);
  const auto angle = [](double t) { return t < 0.5 ? t * t : t - 0.25; };
  table.motion = [=](double t) {
    return RigidMotion{.rotation = Eigen::AngleAxisd(angle(t), Vec3::UnitY()).toRotationMatrix()};
  };
  simulator.addObstacle(table);
  while (simulator.time() < 1.5) REQUIRE(simulator.step());
  const Vec3 there = Vec3(0.1, 0.02, 0) + meanDisplacement(*simulator.body(id));
  const Vec3 expected = Eigen::AngleAxisd(angle(simulator.time()), Vec3::UnitY()) * Vec3(0.1, 0.02, 0);
  CHECK(std::abs(there[0] - expected[0]) < 5e-4);
  CHECK(std::abs(there[2] - expected[2]) < 5e-4);
}

TEST_CASE("a block tips over the sharp edge of a table without going into it") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, kDown));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0.002, -0.03), Vec3(0.05, 0.042, 0.03), 0.02, rubber(5e4, 100.0), 6));
  simulator.addObstacle(solidBox(Vec3(-0.5, -0.1, -0.5), Vec3(0, 0, 0.5), 0.3));
  double most = 0.0;
  while (simulator.time() < 0.5) {
    REQUIRE(simulator.step());
    most = std::max(most, totalEnergy(simulator, id));
  }
  CHECK(most < 1e-6);  // it only falls; 1e-6 of m g h
  CHECK(extent(*simulator.body(id), Vec3::UnitY()).high < 0.0);
  CHECK(simulator.body(id)->contact.deepest < 5e-4);
}

TEST_CASE("what passes beside an obstacle is not touched, however near and fast") {
  const double speed = GENERATE(1.0, 10.0, 100.0);
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::backwardEuler);
  CAPTURE(speed, static_cast<int>(integrator));
  Simulator simulator;
  simulator.setWorld(worldOf(integrator, Vec3::Zero()));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0.05, -0.03), Vec3(0.03, 0.11, 0.03), 0.02, rubber(1e5)));
  simulator.addObstacle(solidBox(Vec3(0.031, -0.5, -0.005), Vec3(0.041, 0, 0.005), 0.3));
  Body &body = *simulator.body(id);
  body.setInitialVelocity(Vec3(0, -speed, 0), Vec3::Zero());
  body.reset();
  while (simulator.time() < 0.3 / speed) REQUIRE(simulator.step());
  CHECK_THAT(meanVelocity(body)[1], WithinRel(-speed, 1e-9));
  CHECK(std::abs(meanVelocity(body)[0]) < 1e-9 * speed);
}

TEST_CASE("a body that touches nothing asks hardly anybody") {
  Simulator simulator;
  simulator.setWorld(worldOf(Integrator::explicitVerlet, Vec3::Zero()));
  Asked asked;
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 1, -0.03), Vec3(0.03, 1.06, 0.03), 0.02, rubber(1e4)));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3, &asked));
  Body &body = *simulator.body(id);
  body.setInitialVelocity(Vec3(0, -1, 0), Vec3::Zero());
  body.reset();
  while (simulator.time() < 0.9) REQUIRE(simulator.step());
  CHECK(simulator.steps() > 100);
  // Once at the beginning, to initialise its distance, and when that distance is used up.
  CHECK(asked.closest <= 3 * body.rest().contact.count());
  CHECK(asked.crossing <= 3 * body.rest().contact.count());
}

TEST_CASE("an obstacle that comes near uses up the free way of a body that stands still") {
  Simulator simulator;
  simulator.setWorld(worldOf(Integrator::explicitVerlet, Vec3::Zero()));
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0, -0.03), Vec3(0.03, 0.06, 0.03), 0.02, rubber(5e4, 50.0)));
  Obstacle lift = halfSpace(Vec3(0, -1, 0), Vec3::UnitY(), 0.3);
  lift.motion = [](double t) { return RigidMotion{.displacement = Vec3(0, 10.0 * t, 0)}; };
  simulator.addObstacle(lift);
  while (simulator.time() < 0.2) REQUIRE(simulator.step());
  CHECK(extent(*simulator.body(id), Vec3::UnitY()).low > -1.0 + 10.0 * simulator.time() - 1e-4);
  CHECK(meanVelocity(*simulator.body(id))[1] > 10.0);
}

TEST_CASE("a free body that is put down quasi-statically lies on the floor, soft or stiff") {
  // 6 cm of 1000 kg/m³ press with 590 Pa; 20 GPa moves less than the tolerance while it still falls.
  const auto [youngs, poisson] =
      GENERATE(std::pair(1e4, 0.3), std::pair(1e6, 0.3), std::pair(2e10, 0.3), std::pair(2e10, 0.4999));
  CAPTURE(youngs, poisson);
  Material material = rubber(youngs);
  material.poissonRatio = poisson;
  Simulator simulator;
  WorldSettings world = worldOf(Integrator::quasiStatic, kDown);
  world.loadSteps = 2;
  simulator.setWorld(world);
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0.05, -0.03), Vec3(0.03, 0.11, 0.03), 0.02, material));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  while (!simulator.finished()) REQUIRE(simulator.step());
  CHECK_FALSE(simulator.body(id)->stopped);
  // Down to the penetration of the penalty, ρ g H d/(30 E), four times that at the edges, and the tolerance of the
  // solution.
  const Extent lies = extent(*simulator.body(id), Vec3::UnitY());
  CHECK_THAT(lies.low, WithinAbs(0.0, 4.0 * 590.0 * 0.02 / (30.0 * youngs) + 1e-5));
  // ρ g H²/(2 E) shorter, within a fifth for the bulging sides.
  CHECK_THAT(lies.high - lies.low, WithinAbs(0.06 - 590.0 * 0.06 / (2.0 * youngs), 0.2 * 590.0 * 0.06 / youngs + 2e-5));
}

TEST_CASE("contact is as stiff as the material that touches, not as the stiffest of the body") {
  const BodyShape shape = box(Vec3(-0.03, 0.0, -0.03), Vec3(0.03, 0.08, 0.03), 8);
  auto body = shapes::makeBody(
      shapes::restState(
          shape, {.sampling = {.spacing = 0.02, .materials = {{BoxRegion{Vec3(-1, 0.04, -1), Vec3(1, 1, 1)}, 1}}}}),
      {rubber(1e4), rubber(1e8)});
  const std::vector<Vec3> places = [&] {
    const std::span<const Vec3> x = body->contactPositions(serialFor());
    return std::vector<Vec3>(x.begin(), x.end());
  }();
  REQUIRE(body->contactModuli().size() == places.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (places[p][1] < 0.02) CHECK(body->contactModuli()[p] == 1e4);
    if (places[p][1] > 0.06) CHECK(body->contactModuli()[p] == 1e8);
  }
  // It sinks as deep as a uniformly soft body, whose sides bulge as much: ρ g H d/(30 E) of 785 Pa in the mean.
  Simulator simulator;
  WorldSettings world = worldOf(Integrator::quasiStatic, kDown);
  world.loadSteps = 2;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(std::move(body));
  simulator.addObstacle(halfSpace(Vec3::Zero(), Vec3::UnitY(), 0.3));
  while (!simulator.finished()) REQUIRE(simulator.step());
  const double mean = 785.0 * 0.02 / (30.0 * 1e4);
  const double low = extent(*simulator.body(id), Vec3::UnitY()).low;
  CHECK(low < -0.8 * mean);
  CHECK(low > -4.0 * mean - 1e-5);
}

TEST_CASE("held patches are as stiff as the material around them") {
  const BodyShape shape = box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  const auto rest = shapes::restState(
      shape, {.sampling = {.spacing = 0.02, .materials = {{BoxRegion{Vec3(0.1, -1, -1), Vec3(1, 1, 1)}, 1}}},
              .fixes = {{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(0.013, 1, 1)}}}});
  const Body body("bar", rest, Constitution{{rubber(1e4), rubber(1e8)}, kLatticeStabilisation}, serialFor());
  const std::vector<double> &areas = rest->conditions.held.front().areas;
  REQUIRE(!areas.empty());
  for (std::size_t p = 0; p < areas.size(); ++p)
    CHECK_THAT(body.patches().stiffness()[p], WithinRel(kPatchStiffness * 1e4 * areas[p] / rest->spacing, 1e-12));
}

TEST_CASE("points of contact know the spacing of the cells that carry them") {
  const BodyShape shape = box(Vec3(0, 0, 0), Vec3(0.08, 0.04, 0.04), 16);
  const auto rest = shapes::restState(
      shape,
      {.sampling = {.spacing = 0.01, .refinements = {{BoxRegion{Vec3(0, 0, 0), Vec3(0.02, 0.04, 0.04)}, 0.005}}}});
  const ContactPoints &points = rest->contact;
  REQUIRE(points.spacings.size() == points.count());
  std::vector<Vec3> places(points.count());
  interpolateField(points.binding, rest->positions, places, serialFor());
  for (std::size_t p = 0; p < points.count(); ++p) {
    const double x = (places[p] + rest->origin)[0];
    if (x < 0.014) CHECK_THAT(points.spacings[p], WithinRel(0.005, 1e-9));
    if (x > 0.045) CHECK_THAT(points.spacings[p], WithinRel(0.01, 1e-9));
  }
}
