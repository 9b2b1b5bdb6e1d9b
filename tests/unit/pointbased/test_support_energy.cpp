// SPDX-License-Identifier: Apache-2.0
// The energy stored in supports, and the sum of all energies.
#include <cmath>

#include "pointbased/simulator.h"
#include "pointbased/support_energy.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::WithinRel;

namespace {

struct Setup {
  const char *name;
  Surface surface;
  std::vector<Fix> fixes;
};

Fix heldIn(const Vec3 &min, const Vec3 &max) { return Fix{.region = BoxRegion{min, max}}; }

std::vector<Setup> setups() {
  const Surface beam = shapes::boxSurface(Vec3::Zero(), Vec3(0.2, 0.04, 0.04), 4);
  return {
      {"a beam held at its face", beam, {heldIn(Vec3(-1, -1, -1), Vec3(0, 1, 1))}},
      {"a beam held within cells", beam, {heldIn(Vec3(-1, -1, -1), Vec3(0.033, 1, 1))}},
      {"a beam held at both ends",
       beam,
       {heldIn(Vec3(-1, -1, -1), Vec3(0, 1, 1)), heldIn(Vec3(0.2, -1, -1), Vec3(1, 1, 1))}},
      {"a ball held at a cap",
       shapes::ballSurface(Vec3::Zero(), 0.05, 12),
       {heldIn(Vec3(-1, 0.03, -1), Vec3(1, 1, 1))}},
  };
}

std::unique_ptr<Body> bodyOf(const Setup &setup, double spacing, MaterialLaw law, std::vector<Load> loads = {}) {
  const Material material{.law = law, .youngsModulus = 1e5, .poissonRatio = 0.4};
  return shapes::makeBody(
      shapes::restState(shapes::inside(setup.surface),
                        {.sampling = {.spacing = spacing}, .fixes = setup.fixes, .loads = std::move(loads)}),
      {material});
}

// J, of the dead loads at the current displacements.
double workOfLoads(const Body &body) {
  const BoundaryConditions &conditions = body.rest().conditions;
  double work = 0.0;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l) {
    const Interpolation &points = conditions.loaded[l].points;
    for (std::size_t p = 0; p < points.count(); ++p)
      for (Index e = points.phyxels.offsets[p]; e < points.phyxels.offsets[p + 1]; ++e)
        work += conditions.loaded[l].shares[p] * points.weights[e] *
                conditions.loads[l].force.dot(body.state().displacements[points.phyxels.indices[e]]);
  }
  return work;
}

}  // namespace

// Clapeyron 1833: of a linear static solution the stored energy is half of the work of the loads.
TEST_CASE("strain, stabilisation and supports store half of the work of the loads") {
  for (const Setup &setup : setups())
    for (const double spacing : {0.02, 0.0131})
      for (const bool isLoaded : {false, true}) {
        CAPTURE(setup.name, spacing, isLoaded);
        std::vector<Load> loads;
        if (isLoaded) {
          Load load{.region = BoxRegion{Vec3(0.08, -1, -1), Vec3(0.12, 1, 1)}};
          if (setup.name[2] == 'b' && setup.name[3] == 'a')
            load.region = BoxRegion{Vec3(-1, -1, -1), Vec3(1, -0.02, 1)};
          load.force = Vec3(0.1, 0.2, -0.3);
          loads.push_back(load);
        }
        Simulator simulator;
        simulator.setWorld({.gravity = Vec3(1.0, -9.81, 2.0), .integrator = Integrator::quasiStatic, .loadSteps = 1});
        const std::size_t id = simulator.addBody(bodyOf(setup, spacing, MaterialLaw::linear, loads));
        while (!simulator.finished()) REQUIRE(simulator.step());
        REQUIRE(simulator.stepper().stoppedBodies() == 0);
        const Body &body = *simulator.body(id);
        const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
        const double work = workOfLoads(body) - energy.gravity, supports = supportEnergy(body);
        CHECK_THAT(energy.elastic + energy.stabilisation + supports, WithinRel(0.5 * work, 1e-3));
        // Without them it would not hold, unless phyxels on the face are held themselves.
        if (body.patches().rows() > 0)
          CHECK(supports > 1e-3 * work);
        else
          CHECK(supports == 0.0);
      }
}

TEST_CASE("a supported body that swings keeps the sum of its energies") {
  const Integrator integrator = GENERATE(Integrator::explicitVerlet, Integrator::implicitMidpoint);
  CAPTURE(static_cast<int>(integrator));
  Simulator simulator;
  WorldSettings world{.gravity = Vec3(0, -9.81, 0), .integrator = integrator};
  if (integrator == Integrator::implicitMidpoint) world.dt = 2e-4;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(bodyOf(setups()[0], 0.0131, MaterialLaw::neoHookean));
  double most = 0.0, least = 0.0, stored = 0.0, inSupports = 0.0;
  while (simulator.time() < 0.15) {
    REQUIRE(simulator.step());
    const Diagnostics::Energy energy = simulator.diagnostics().energy(id);
    const double supports = supportEnergy(*simulator.body(id));
    const double total = energy.kinetic + energy.elastic + energy.stabilisation + energy.gravity + supports;
    most = std::max(most, total);
    least = std::min(least, total);
    stored = std::max(stored, energy.elastic + energy.stabilisation);
    inSupports = std::max(inSupports, supports);
  }
  CAPTURE(most, least, stored, inSupports);
  CHECK(most - least < 2e-3 * stored);
  CHECK(inSupports > 5e-3 * stored);
}
