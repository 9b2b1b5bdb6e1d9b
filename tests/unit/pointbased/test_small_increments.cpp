// SPDX-License-Identifier: Apache-2.0
// Implicit steps whose increments are far smaller than the tolerance of a solution.
#include <cmath>

#include "c3de/core/thread_pool.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::WithinRel;

namespace {

constexpr double kEdge = 0.1;  // m

std::unique_ptr<Body> block(double modulus, bool isHeld, std::vector<Load> loads = {}) {
  BodyRecipe recipe{.sampling = {.spacing = 0.025}, .loads = std::move(loads)};
  if (isHeld) {
    recipe.fixes.push_back({.region = BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1e-3, 1)}});
  }
  const Material material{.youngsModulus = modulus, .poissonRatio = 0.3};
  return shapes::makeBody(
      shapes::restState(shapes::inside(shapes::boxSurface(Vec3::Zero(), Vec3(kEdge, 2 * kEdge, kEdge), 4)), recipe),
      {material});
}

WorldSettings settings(Integrator integrator, double dt, double gravity) {
  return WorldSettings{.gravity = Vec3(0, -gravity, 0), .integrator = integrator, .dt = dt};
}

// Mean of the momentum over the weight, in units of g, of the phyxels in the upper quarter: g t in free fall. This also
// holds for a supported body, whose phyxels have weights other than their masses.
Vec3 upperMean(const Body &body, std::span<const Vec3> field) {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i)
    if ((body.rest().origin + body.rest().positions[i]).y() > 1.5 * kEdge) {
      sum += body.masses()[i] * field[i];
      weight += body.weights()[i];
    }
  return sum / weight;
}

}  // namespace

// c = 11 m/s: during these steps no wave arrives from the support, so both halves fall freely.
TEST_CASE("an increment far below the tolerance of a solution is taken, in free fall and of a held body") {
  const Integrator integrator =
      GENERATE(Integrator::implicitSdirk, Integrator::implicitMidpoint, Integrator::backwardEuler);
  const double dt = GENERATE(1e-4, 1e-5, 1e-6, 1e-7);
  const double gravity = GENERATE(9.81, 0.1, 1e-4);
  const bool isHeld = GENERATE(false, true);
  CAPTURE(static_cast<int>(integrator), dt, gravity, isHeld);
  Simulator simulator;
  simulator.setWorld(settings(integrator, dt, gravity));
  const std::size_t id = simulator.addBody(block(1e5, isHeld));
  constexpr int kSteps = 20;
  for (int k = 0; k < kSteps; ++k) REQUIRE(simulator.step());
  const double t = kSteps * dt;
  const Body &body = *simulator.body(id);
  // In 2 ms stresses transport 1 % of the momentum across the lower border of the quarter.
  const double bound = isHeld && dt > 5e-5 ? 0.015 : 2e-3;
  const double way = integrator == Integrator::backwardEuler ? 0.5 * gravity * t * (t + dt) : 0.5 * gravity * t * t;
  CHECK_THAT(-upperMean(body, body.state().velocities).y(), WithinRel(gravity * t, bound));
  CHECK_THAT(-upperMean(body, body.state().displacements).y(), WithinRel(way, 2.0 * bound));
  CHECK(simulator.diagnostics().energy(id).kinetic > 0.0);
  CHECK(simulator.diagnostics().energy(id).gravity < 0.0);
}

// In explicit steps no increment is ever dropped.
TEST_CASE("a held body under a small force moves in small implicit steps as in explicit ones") {
  const double force = GENERATE(1e-3, 1e-9);
  const double dt = 2e-5;
  CAPTURE(force);
  const auto wayWith = [&](Integrator integrator) {
    const Load load{.region = BoxRegion{Vec3(-1, 2 * kEdge - 1e-6, -1), Vec3(1, 1, 1)}, .force = Vec3(force, 0, 0)};
    Simulator simulator;
    simulator.setWorld(settings(integrator, dt, 0.0));
    const std::size_t id = simulator.addBody(block(1e5, true, {load}));
    for (int k = 0; k < 500; ++k) REQUIRE(simulator.step());
    return upperMean(*simulator.body(id), simulator.body(id)->state().displacements).x();
  };
  const double explicitly = wayWith(Integrator::explicitVerlet);
  REQUIRE(explicitly > 0.0);
  CHECK_THAT(wayWith(Integrator::implicitSdirk), WithinRel(explicitly, 5e-3));
}

// A body at rest stays at rest, and costs no solution.
TEST_CASE("a body without loads rests in implicit steps of any size, exactly") {
  const double dt = GENERATE(1e-2, 1e-5);
  Simulator simulator;
  simulator.setWorld(settings(Integrator::implicitSdirk, dt, 0.0));
  const std::size_t id = simulator.addBody(block(1e5, true));
  for (int k = 0; k < 3; ++k) REQUIRE(simulator.step());
  for (const Vec3 &u : simulator.body(id)->state().displacements) REQUIRE(u.isZero(0.0));
}
