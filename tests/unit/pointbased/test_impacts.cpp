// SPDX-License-Identifier: Apache-2.0
// Impacts in explicit steps: their duration, and the effect of restitution.
#include <algorithm>
#include <cmath>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"

using namespace pointbased;
using namespace shapes;

namespace {

Obstacle ground(double restitution, double friction = 0.0) {
  Obstacle obstacle = halfSpace(Vec3::Zero(), Vec3::UnitY(), friction);
  obstacle.restitution = restitution;
  return obstacle;
}

struct Impact {
  double contactTime = 0.0;  ///< in units of 2 L/c
  double rebound = 0.0;      ///< speed of the centre of mass, relative to the impact speed
  double kept = 0.0;         ///< energy after the impact, relative to that before
  double highest = 0.0;      ///< largest energy in between, relative to that before
};

/// A free elastic cube, edge L, hits the ground flat.
Impact impactOfCube(int cells, double restitution, double poissonRatio, double speed) {
  constexpr double kEdge = 0.1;
  Simulator simulator;
  simulator.setWorld({.integrator = Integrator::explicitVerlet});
  Material material = rubber(1e5);
  material.poissonRatio = poissonRatio;
  auto cube = latticeBox(Vec3(0.0, 0.001, 0.0), Vec3(kEdge, 0.001 + kEdge, kEdge), kEdge / cells, material, cells);
  cube->setInitialVelocity(Vec3(0.0, -speed, 0.0), Vec3::Zero());
  const std::size_t id = simulator.addBody(std::move(cube));
  simulator.addObstacle(ground(restitution));
  const double period = 2.0 * kEdge / std::sqrt(material.youngsModulus / material.restDensity);
  const double before = totalEnergy(simulator, id);
  Impact out;
  double first = -1.0, last = 0.0;
  while (simulator.time() < 3.0 * period + 0.001 / speed) {
    REQUIRE(simulator.step());
    bool presses = false;
    for (const Contact &contact : simulator.body(id)->contact.active) presses = presses || contact.normalImpulse > 0.0;
    if (presses && first < 0.0) first = simulator.time();
    if (presses) last = simulator.time();
    out.highest = std::max(out.highest, totalEnergy(simulator, id) / before);
  }
  out.contactTime = (last - first) / period;
  out.rebound = meanVelocity(*simulator.body(id)).y() / speed;
  out.kept = totalEnergy(simulator, id) / before;
  return out;
}

}  // namespace

TEST_CASE("a point leaves with its restitution times the speed with which it came, and comes to rest in the end") {
  for (const double restitution : {0.3, 0.8, 1.0}) {
    INFO("restitution " << restitution);
    Simulator simulator;
    simulator.setWorld(
        {.gravity = Vec3(0.0, -9.81, 0.0), .integrator = Integrator::explicitVerlet, .dt = 1e-4, .sleep = false});
    const std::size_t id = simulator.addBody(std::make_unique<Body>(
        "point", restState(std::vector<Vec3>{Vec3(0.0, 0.1, 0.0)}, 0.01), Constitution{}, serialFor()));
    simulator.addObstacle(ground(restitution));
    const State &state = simulator.body(id)->state();
    double came = 0.0;
    while (state.velocities[0].y() <= 0.0) {
      came = -state.velocities[0].y();
      REQUIRE(simulator.step());
    }
    CHECK_THAT(state.velocities[0].y(), WithinRel(restitution * came, 5e-3));
    double top = -1.0;
    while (state.velocities[0].y() > 0.0) {
      REQUIRE(simulator.step());
      top = std::max(top, state.displacements[0].y());
    }
    const double drop = 0.1 - 0.005;  // its contact radius
    CHECK_THAT(top + drop, WithinRel(restitution * restitution * drop, 0.02));
    for (int k = 0; k < 20'000; ++k) REQUIRE(simulator.step());
    if (restitution < 0.5) CHECK(state.velocities[0].norm() < 1e-9);
    if (restitution == 1.0)
      CHECK_THAT(totalEnergy(simulator, id), WithinAbs(0.0, 0.02 * 9.81 * 0.1 * simulator.body(id)->totalMass()));
  }
}

TEST_CASE(
    "an elastic bar leaves the ground after 2 L/c with the speed with which it came, the better the finer it is") {
  // ν = 0: a cube is a bar. A point that arrives is stopped (restitution 0): the kinetic energy of the first cells is
  // lost.
  double before = 1.0;
  for (const int cells : {6, 12}) {
    const Impact bar = impactOfCube(cells, 0.0, 0.0, 0.2);
    INFO(cells << " cells: contact " << bar.contactTime << ", rebound " << bar.rebound << ", kept " << bar.kept);
    CHECK_THAT(bar.contactTime, WithinAbs(1.0, 0.12));
    CHECK(bar.highest <= 1.0 + 1e-6);
    CHECK(1.0 - bar.kept < 0.5 / cells);
    CHECK(1.0 - bar.kept < 0.7 * before);
    before = 1.0 - bar.kept;
    CHECK(bar.rebound > 1.0 - 0.75 / cells);
    CHECK(bar.rebound < 1.0);
  }
}

TEST_CASE("restitution that implicit steps do not know is told of at the start, once") {
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk}) {
    Simulator simulator;
    simulator.setWorld({.integrator = integrator});
    simulator.addBody(latticeBox(Vec3(0, 0.1, 0), Vec3(0.1, 0.2, 0.1), 0.05, rubber(1e5), 2));
    simulator.addObstacle(ground(0.5));
    for (int k = 0; k < 3; ++k) REQUIRE(simulator.step());
    const auto told = shapes::countEvents(simulator, "warning", "restitution counts in explicit steps alone");
    CHECK(told == (integrator == Integrator::explicitVerlet ? 0 : 1));
  }
}

TEST_CASE("at restitution 1 contact takes no energy and adds none, however much a body rattles") {
  for (const double poissonRatio : {0.0, 0.3, 0.45})
    for (const double speed : {0.2, 2.0}) {
      const Impact impact = impactOfCube(6, 1.0, poissonRatio, speed);
      INFO("ν " << poissonRatio << ", " << speed << " m/s: kept " << impact.kept << ", highest " << impact.highest);
      // Verlet conserves a perturbed energy, whose difference is of the square of the step.
      CHECK(impact.kept > 0.94);
      CHECK(impact.highest < 1.03);
      CHECK(impact.kept > impactOfCube(6, 0.0, poissonRatio, speed).kept);
    }
}
