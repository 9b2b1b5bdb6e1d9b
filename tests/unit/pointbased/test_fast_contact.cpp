// SPDX-License-Identifier: Apache-2.0
// Bodies that hit thin obstacles faster than their own speed of sound.
#include <algorithm>
#include <cmath>

#include "contact_cases.h"
#include "shapes.h"
#include "support/catch.h"
#include "touching_bodies.h"

using namespace pointbased;
using namespace shapes;

namespace {

constexpr double kPlate = 0.004;  // m, thickness: from y = -4 mm to 0

void hitPlate(double speed, Integrator integrator) {
  CAPTURE(static_cast<int>(integrator), speed);
  Simulator simulator;
  simulator.setWorld({.integrator = integrator});
  const std::size_t id =
      simulator.addBody(latticeBox(Vec3(-0.03, 0.0207, -0.03), Vec3(0.03, 0.0807, 0.03), 0.012, soft(5e4, 0.45, 20.0)));
  simulator.addObstacle(solidBox(Vec3(-0.5, -kPlate, -0.5), Vec3(0.5, 0, 0.5), 0.3));
  Body &body = *simulator.body(id);
  body.setInitialVelocity(Vec3(0, -speed, 0), Vec3::Zero());
  body.reset();
  double lowest = 1.0, reportedDepth = 0.0;
  bool stopped = false;
  while (!stopped && simulator.time() < 0.1 / speed + 0.05) {
    stopped = !simulator.step();
    lowest = std::min(lowest, extent(body, Vec3::UnitY()).low);
    reportedDepth = std::max(reportedDepth, simulator.diagnostics().skinDepth(id));
  }
  std::size_t behind = 0;
  for (const Vec3 &x : body.contactPositions(serialFor()))
    if (x[1] < -0.5 * kPlate) ++behind;
  CAPTURE(stopped, behind, lowest, reportedDepth);
  CHECK((stopped || behind == 0));
  CHECK(reportedDepth >= std::min(0.02, 0.9 * -lowest));
}

}  // namespace

TEST_CASE("a body at 30 and 300 m/s does not pass a plate of 4 mm, or stops and reports its depth") {
  hitPlate(GENERATE(30.0, 300.0), GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk,
                                           Integrator::implicitMidpoint, Integrator::backwardEuler));
}

TEST_CASE("a body at 60 and 120 m/s does not pass a plate of 4 mm either", "[slow]") {
  hitPlate(GENERATE(60.0, 120.0), GENERATE(Integrator::explicitVerlet, Integrator::implicitSdirk,
                                           Integrator::implicitMidpoint, Integrator::backwardEuler));
}
