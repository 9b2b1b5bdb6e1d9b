// SPDX-License-Identifier: Apache-2.0
// Viscosity of the modes that one evaluation per cell does not capture.
#include <cmath>

#include "engine_cases.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

constexpr double kEdge = 0.02;  // m

std::unique_ptr<Body> cube(double viscosity, MaterialLaw law = MaterialLaw::neoHookean) {
  const BodyRecipe recipe{.sampling = {.spacing = kEdge / 2}};
  const Material material{.law = law, .youngsModulus = 5e4, .poissonRatio = 0.45, .viscosity = viscosity};
  return shapes::makeBody(
      shapes::restState(shapes::inside(shapes::boxSurface(Vec3::Zero(), Vec3::Constant(kEdge), 2)), recipe),
      {material});
}

// Velocities that bend and twist it, and no momentum.
void shake(Body &body, double speed) {
  std::vector<Vec3> &v = body.state().velocities;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec3 x = (body.rest().origin + body.rest().positions[i] - Vec3::Constant(0.5 * kEdge)) / (0.5 * kEdge);
    v[i] = speed * Vec3(x.y() * x.z(), -x.x() * x.z() + x.x() * x.y() * x.z(), 0.5 * x.x() * x.y());
  }
}

double vibration(const Simulator &simulator, std::size_t id) {
  const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
  const Body &body = *simulator.body(id);
  Vec3 momentum = Vec3::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < body.masses().size(); ++i) {
    momentum += body.masses()[i] * body.state().velocities[i];
    mass += body.masses()[i];
  }
  return energy.kinetic + energy.elastic + energy.stabilisation - 0.5 * momentum.squaredNorm() / mass;
}

}  // namespace

// The retardation time of the modes is 0.21 ms; the slowest mode of the cube takes some 10 ms.
TEST_CASE("a small viscous cube comes to rest, whatever it rings in") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk);
  const MaterialLaw law = GENERATE(MaterialLaw::neoHookean, MaterialLaw::linear);
  CAPTURE(static_cast<int>(integrator), static_cast<int>(law));
  Simulator simulator;
  WorldSettings world{.integrator = integrator};
  if (integrator == Integrator::implicitSdirk) world.dt = 5e-4;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(cube(20.0, law));
  shake(*simulator.body(id), 0.05);
  const double before = vibration(simulator, id);
  double last = before;
  while (simulator.time() < 0.4) {
    REQUIRE(simulator.step());
    const double now = vibration(simulator, id);
    REQUIRE(now < 1.02 * last + 1e-6 * before);
    last = now;
  }
  CHECK(last < 1e-4 * before);
}

TEST_CASE("the viscosity of modes takes power, and none from a rigid motion") {
  using namespace engine_cases;
  for (const EngineCase &c : all())
    for (const MaterialLaw law : {MaterialLaw::neoHookean, MaterialLaw::corotated, MaterialLaw::linear}) {
      if (!c.stencils.isLattice()) continue;
      CAPTURE(c.name, nameOf(law));
      const Constitution still = constitution(c, law);
      Constitution viscous = still;
      viscous.materials[0].viscosity = 50.0;
      const std::vector<Vec3> u = noise(c, 0.1 * c.spacing, 7), v = noise(c, 1.0, 8);
      std::vector<Vec3> rigid(c.phyxels());
      const Vec3 spin(3.0, -2.0, 5.0), speed(1.0, 2.0, 3.0);
      for (std::size_t i = 0; i < u.size(); ++i) {
        // The linear law does not account for the rotation of a strained body.
        rigid[i] = law == MaterialLaw::linear ? speed : Vec3(speed + spin.cross(c.positions[i] + u[i]));
      }
      const auto viscousPart = [&](std::span<const Vec3> velocities) {
        return plus(evaluate(c, viscous, u, {}, 0.0, velocities).forces, -1.0, evaluate(c, still, u).forces);
      };
      const std::vector<Vec3> change = viscousPart(v);
      CHECK(dot(change, v) < 0.0);
      CHECK(largest(viscousPart(rigid)) < 1e-9 * largest(change));
    }
}

// In a pure mode the mean gradient of a cell does not change: only the viscosity of the modes acts.
TEST_CASE("a cell that is bent and twisted is damped") {
  using namespace engine_cases;
  const EngineCase c = lattice(1, 1, 1, false);
  const Constitution still = constitution(c, MaterialLaw::neoHookean);
  Constitution viscous = still;
  viscous.materials[0].viscosity = 50.0;
  const std::vector<Vec3> u(c.phyxels(), Vec3::Zero());
  Vec3 centre = Vec3::Zero();
  for (const Vec3 &X : c.positions) centre += X / static_cast<double>(c.phyxels());
  for (int mode = 0; mode < 4; ++mode) {
    CAPTURE(mode);
    std::vector<Vec3> v(c.phyxels());
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Vec3 s = (c.stencils.axes.transpose() * (c.positions[i] - centre)).cwiseSign();
      const double products[] = {s.x() * s.y(), s.x() * s.z(), s.y() * s.z(), s.x() * s.y() * s.z()};
      v[i] = c.stencils.axes * Vec3(products[mode], 0.5 * products[mode], -0.2 * products[mode]);
    }
    const std::vector<Vec3> change =
        plus(evaluate(c, viscous, u, {}, 0.0, v).forces, -1.0, evaluate(c, still, u).forces);
    CHECK(dot(change, v) < 0.0);
  }
}
