// SPDX-License-Identifier: Apache-2.0
// A relaxing body, held and stepped.
#include <cmath>

#include "pointbased/simulator.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;

namespace {

constexpr double kLength = 0.04, kWidth = 0.02, kRamp = 0.1;  // m, m, s
constexpr PronyTerm kTerm{0.6, 0.5};

// A bar of two cells across, one end rotated against the other.
std::unique_ptr<Body> twistedBar(const Material &material) {
  const BodyShape shape = shapes::box(Vec3(0, -kWidth / 2, -kWidth / 2), Vec3(kLength, kWidth / 2, kWidth / 2), 4);
  BodyRecipe recipe{.sampling = {.spacing = kWidth / 2}};
  for (const double x : {0.0, kLength}) {
    Fix fix{.region = BoxRegion{Vec3(x - 1e-7, -1, -1), Vec3(x + 1e-7, 1, 1)}};
    if (x > 0.0) {
      fix.rotation_deg = Vec3(3, 0, 0);
      fix.centre = Vec3(x, 0, 0);
      fix.ramp = kRamp;
    }
    recipe.fixes.push_back(fix);
  }
  return shapes::makeBody(shapes::restState(shape, recipe), {material});
}

Material rubber() { return Material{.law = MaterialLaw::stVenantKirchhoff, .youngsModulus = 1e4, .poissonRatio = 0.3}; }

double torqueAt(Simulator &simulator, std::size_t id, double time) {
  while (simulator.time() < time - 1e-9) REQUIRE(simulator.step());
  return simulator.diagnostics().reactions(id)[1].torque[0];
}

WorldSettings stepping(Integrator integrator, double dt) {
  return WorldSettings{.integrator = integrator, .dt = dt, .damping = 30.0};
}

}  // namespace

TEST_CASE("relaxing body: the torque of a held twist falls as G(t) with every integrator, and no step is divided") {
  // Equal to the elastic bar after the same time, times G(t) of a strain that grows along the ramp and then stays
  // constant.
  Simulator elastic;
  elastic.setWorld(stepping(Integrator::implicitSdirk, 0.02));
  const std::size_t id = elastic.addBody(twistedBar(rubber()));
  const double t = 1.0, atOnce = torqueAt(elastic, id, t);
  const double G = 1 - kTerm.share +
                   kTerm.share * kTerm.time / kRamp * (std::exp(kRamp / kTerm.time) - 1) * std::exp(-t / kTerm.time);
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::backwardEuler}) {
    INFO("integrator " << static_cast<int>(integrator));
    Material material = rubber();
    material.prony[0] = kTerm;
    Simulator simulator;
    simulator.setWorld(stepping(integrator, integrator == Integrator::explicitVerlet ? 0.0005 : 0.02));
    const std::size_t bar = simulator.addBody(twistedBar(material));
    // The ends restrain warping, which needs some change of volume: that does not relax. Steps of 0.04 of the time:
    // h²/12.
    CHECK(torqueAt(simulator, bar, t) == Approx(G * atOnce).epsilon(0.003));
    for (const SimulationEvent &event : simulator.diagnostics().events()) CHECK(event.kind != "smaller_step");
  }
}

TEST_CASE("relaxing body: what modes remember is part of the state, is kept, restored and reset with it") {
  Material material = rubber();
  material.prony[0] = kTerm;
  Simulator simulator;
  simulator.setWorld(stepping(Integrator::backwardEuler, 0.02));
  const std::size_t id = simulator.addBody(twistedBar(material));
  Body &body = *simulator.body(id);
  const std::uint64_t fresh = simulator.stateHash();
  (void)torqueAt(simulator, id, 0.2);
  REQUIRE(body.state().history.modes.size() == body.rest().pointCount());
  CHECK(body.state().history.modes[0].relaxed[0].norm() > 0.0);

  // Evaluating a step does not advance the history; making the step does.
  body.keepState();
  const std::uint64_t before = simulator.stateHash();
  body.computeTrialStresses(0.1, serialFor());
  CHECK(simulator.stateHash() == before);
  body.computeStresses(0.1, serialFor());
  const std::uint64_t later = simulator.stateHash();
  CHECK(later != before);
  body.state().history.modes[0].relaxed[1](1, 2) += 1.0;
  CHECK(simulator.stateHash() != later);
  body.restoreState();
  CHECK(simulator.stateHash() == before);

  // The trial's forces are those of the step, not of the history at its beginning.
  body.computeTrialStresses(0.1, serialFor());
  body.computeInternalForces(serialFor());
  const std::vector<Vec3> trial(body.forces().begin(), body.forces().end());
  body.computeStresses(0.1, serialFor());
  body.computeInternalForces(serialFor());
  CHECK(std::vector<Vec3>(body.forces().begin(), body.forces().end()) == trial);
  body.computeElasticStresses(serialFor());
  body.computeInternalForces(serialFor());
  CHECK(std::vector<Vec3>(body.forces().begin(), body.forces().end()) != trial);

  simulator.reset();
  CHECK(simulator.stateHash() == fresh);
  CHECK(body.state().history.modes[0].relaxed[0].isZero(0.0));

  // A material that no longer relaxes clears its history.
  simulator.world().setConstitution(id, {{rubber()}, kLatticeStabilisation});
  CHECK(body.state().history.modes.empty());
}
