// SPDX-License-Identifier: Apache-2.0
// External forces: another plugin's field, a caller's own grab.
#include <cmath>
#include <limits>
#include <numbers>

#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

std::unique_ptr<Body> organ(double viscosity = 0.0) {
  const Material material{.viscosity = viscosity};
  return shapes::makeBody(shapes::restState(shapes::horseshoe(), 0.025), {material}, "organ");
}

/// A beam on a lattice, held at its left end.
std::unique_ptr<Body> heldBeam() {
  const BodyShape shape = shapes::box(Vec3::Zero(), Vec3(0.2, 0.04, 0.04), 4);
  return shapes::makeBody(
      shapes::restState(shape, {.sampling = {.spacing = 0.02},
                                .fixes = {{.region = BoxRegion{Vec3(-1e-7, -1.0, -1.0), Vec3(1e-7, 1.0, 1.0)}}}}),
      {Material{}}, "beam");
}

/// Different in every step and on every phyxel, up to 5 mN.
std::vector<Vec3> forcesOf(const Body &body, int step) {
  std::vector<Vec3> forces(body.rest().phyxelCount());
  for (std::size_t i = 0; i < forces.size(); ++i)
    for (int c = 0; c < 3; ++c) forces[i][c] = 5e-3 * std::sin(0.7 * static_cast<double>(i) + 2.0 * c + 0.3 * step);
  return forces;
}

Vec3 momentumOf(const Body &body) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < body.masses().size(); ++i) sum += body.masses()[i] * body.state().velocities[i];
  return sum;
}

double largestDifference(const Body &a, const Body &b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.state().displacements.size(); ++i)
    most = std::max(most, (a.state().displacements[i] - b.state().displacements[i]).norm());
  return most;
}

}  // namespace

TEST_CASE("external forces change the momentum of a free body by their impulse, whatever integrates it", "[external]") {
  struct Case {
    Integrator integrator;
    double dt, part;
  };
  // Explicit: to round-off. Implicit: to the tolerance of Newton's method.
  for (const Case &c : {Case{Integrator::explicitVerlet, 0.0, 1e-12}, Case{Integrator::explicitVerlet, 0.02, 1e-12},
                        Case{Integrator::implicitSdirk, 0.01, 1e-9}, Case{Integrator::implicitMidpoint, 0.01, 1e-9}}) {
    INFO("integrator " << static_cast<int>(c.integrator) << ", dt " << c.dt);
    Simulator simulator;
    simulator.setWorld({.integrator = c.integrator, .dt = c.dt, .tolerance = 1e-12});
    const std::size_t id = simulator.addBody(organ());
    const Body &body = *simulator.body(id);
    Vec3 impulse = Vec3::Zero();
    double size = 0.0;
    for (int step = 0; step < 20; ++step) {
      const std::vector<Vec3> forces = forcesOf(body, step);
      simulator.stepper().setExternalForces(id, forces);
      const double before = simulator.time();
      REQUIRE(simulator.step());
      for (const Vec3 &f : forces) {
        impulse += (simulator.time() - before) * f;
        size += (simulator.time() - before) * f.norm();
      }
    }
    CHECK((momentumOf(body) - impulse).norm() <= c.part * size);
  }
}

TEST_CASE("gravity as external forces is gravity: the same motion, and the same rest of a static body", "[external]") {
  for (const Integrator integrator : {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::quasiStatic}) {
    INFO("integrator " << static_cast<int>(integrator));
    const Vec3 g(0.0, -9.81, 0.0);
    Simulator own, outside;
    std::vector<Vec3> weight;
    for (Simulator *simulator : {&own, &outside}) {
      WorldSettings world{.integrator = integrator, .tolerance = 1e-10};
      if (integrator != Integrator::quasiStatic) world.dt = 1e-3;
      if (simulator == &own) world.gravity = g;
      simulator->setWorld(world);
      REQUIRE(simulator->addBody(heldBeam()) == 1);
    }
    const Body &body = *outside.body(1);
    for (const double w : body.weights()) weight.push_back(w * g);
    for (int step = 0; step < 40 && !outside.finished(); ++step) {
      outside.stepper().setExternalForces(1, weight);
      REQUIRE(own.step());
      REQUIRE(outside.step());
    }
    double most = 0.0;
    for (const Vec3 &u : own.body(1)->state().displacements) most = std::max(most, u.norm());
    REQUIRE(most > 1e-5);
    CHECK(largestDifference(*own.body(1), body) < 1e-6 * most);
  }
}

TEST_CASE("external forces that are nothing leave every bit alone, and end when they are taken away", "[external]") {
  Simulator plain, other;
  const std::size_t a = plain.addBody(organ(2.0)), b = other.addBody(organ(2.0));
  const std::vector<Vec3> none(other.body(b)->rest().phyxelCount(), Vec3::Zero());
  for (int step = 0; step < 10; ++step) {
    other.stepper().setExternalForces(b, none);
    REQUIRE(plain.step());
    REQUIRE(other.step());
  }
  CHECK(plain.stateHash() == other.stateHash());
  CHECK(other.body(b)->externalForces().empty());

  other.stepper().setExternalForces(b, forcesOf(*other.body(b), 1));
  REQUIRE(other.step());
  other.stepper().setExternalForces(b, {});
  const Vec3 momentum = momentumOf(*other.body(b));
  REQUIRE(momentum.norm() > 0.0);
  for (int step = 0; step < 50; ++step) REQUIRE(other.step());
  CHECK((momentumOf(*other.body(b)) - momentum).norm() < 1e-12 * momentum.norm());
  (void)a;
}

TEST_CASE("external forces wake a body that sleeps, and a reset takes them away", "[external]") {
  Simulator simulator;
  simulator.setWorld({.sleep = true});
  const std::size_t id = simulator.addBody(organ(2.0));
  for (int step = 0; step < 5000 && !simulator.stepper().asleep(id); ++step) REQUIRE(simulator.step());
  REQUIRE(simulator.stepper().asleep(id));
  simulator.stepper().setExternalForces(id, forcesOf(*simulator.body(id), 3));
  REQUIRE(simulator.step());
  CHECK_FALSE(simulator.stepper().asleep(id));
  CHECK(momentumOf(*simulator.body(id)).norm() > 0.0);
  simulator.reset();
  CHECK(simulator.body(id)->externalForces().empty());
}

TEST_CASE("external forces that tear a body apart stop it in its last good state, with a reason", "[external]") {
  Simulator simulator;
  const std::size_t id = simulator.addBody(organ());
  for (int step = 0; step < 5; ++step) REQUIRE(simulator.step());
  const std::uint64_t hash = simulator.stateHash();
  std::vector<Vec3> forces(simulator.body(id)->rest().phyxelCount(), Vec3::Zero());
  forces[3] = Vec3(1e300, 0.0, 0.0);
  simulator.stepper().setExternalForces(id, forces);
  CHECK_FALSE(simulator.step());
  CHECK(simulator.body(id)->stopped);
  CHECK(simulator.stateHash() == hash);
}
