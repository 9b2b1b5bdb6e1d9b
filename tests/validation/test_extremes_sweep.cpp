// SPDX-License-Identifier: Apache-2.0
// A grid of moduli, spacings, steps and integrators: wherever it ends, it ends finite or with a report.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "extreme_cases.h"
#include "support/catch.h"

using namespace extremes;

namespace {

struct Sweep {
  int runs = 0, stopped = 0;
  double slowest = 0.0;  // s of wall time, a run
};

// Falls, hits a table and is pulled aside by a corner.
void fallAndPull(double youngs, double poisson, double spacing, double dt, Integrator integrator, int steps, Sweep &sweep) {
  CAPTURE(youngs, poisson, spacing, dt, static_cast<int>(integrator));
  Simulator simulator;
  WorldSettings world;
  world.dt = dt;
  world.integrator = integrator;
  world.gravity = Vec3(0, -9.81, 0);
  world.loadSteps = 3;
  simulator.setWorld(world);
  const std::size_t id = simulator.addBody(cube(rubber(youngs, poisson), spacing, 1e-4));
  simulator.addObstacle(shapes::solidBox(Vec3(-0.1, -0.1, -0.1), Vec3(0.1, 0, 0.1), 0.3));
  Body &body = *simulator.body(id);
  if (integrator != Integrator::quasiStatic) {
    body.setInitialVelocity(Vec3(0, -0.5, 0), Vec3(1, 0, 2));
    Grab grab;
    grab.phyxels = {static_cast<Index>(body.rest().phyxelCount() - 1)};
    grab.weights = {1.0};
    grab.target = Vec3(0.1, 0.1, 0.1);
    grab.maxForce = 2.0;
    simulator.setGrab(id, grab);
  }
  const auto start = std::chrono::steady_clock::now();
  bool good = true;
  for (int i = 0; i < steps && good && !simulator.finished(); ++i) good = simulator.step().has_value();
  sweep.slowest = std::max(sweep.slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  ++sweep.runs;
  sweep.stopped += good ? 0 : 1;
  REQUIRE(finite(body));
  REQUIRE(good == body.stopped.empty());
  if (!good) {
    REQUIRE_THAT(body.stopped, Contains("phyxel") && Contains("Help"));
    REQUIRE(told(simulator, "stopped"));
  }
}

void run(std::initializer_list<double> moduli, std::initializer_list<double> ratios, std::initializer_list<double> spacings,
         int steps, const std::string &name) {
  Sweep sweep;
  for (const Integrator integrator :
       {Integrator::explicitVerlet, Integrator::implicitSdirk, Integrator::quasiStatic})
    for (const double youngs : moduli)
      for (const double poisson : ratios)
        for (const double spacing : spacings)
          for (const double dt : {0.0, 1e-6, 1e-3, 0.1}) {
            if (integrator == Integrator::quasiStatic && dt > 0.0) continue;
            fallAndPull(youngs, poisson, spacing, dt, integrator, steps, sweep);
          }
  row(name, std::to_string(sweep.runs) + " runs, " + std::to_string(sweep.runs - sweep.stopped) + " finite to the end, " +
                std::to_string(sweep.stopped) + " stopped with a report");
  std::cout << name << ": slowest run " << sweep.slowest << " s, stopped " << sweep.stopped << " of " << sweep.runs << '\n';
}

}  // namespace

TEST_CASE("whatever modulus, ratio, step and integrator: finite or stopped with a report (corners of the grid)") {
  run({1.0, 2e10}, {0.0, 0.4999}, {0.02}, 8, "sweep: E {1 Pa, 20 GPa} × ν {0, 0.4999} × dt × integrators");
}

TEST_CASE("whatever modulus, ratio, spacing, step and integrator: finite or stopped with a report (all of the grid)", "[.long]") {
  run({1.0, 1e3, 1e6, 2e10}, {0.0, 0.3, 0.45, 0.4999}, {0.02, 0.01}, 30,
      "sweep: E {1 Pa … 20 GPa} × ν {0 … 0.4999} × 2 spacings × dt × integrators");
}
