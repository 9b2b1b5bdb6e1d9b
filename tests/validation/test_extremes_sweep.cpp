// SPDX-License-Identifier: Apache-2.0
// A grid of moduli, ratios, spacings, steps and integrators: every run ends finite or with a report. A body falls on a
// table and is pulled aside by a corner. Nothing hangs: every step returns. Processor time is the criterion, because a
// step that never returned could not be judged at all: one that takes more than kHang has failed. A run whose steps all
// return but whose time is used up before its last step counts as finite "so far", and is listed separately.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>

#include "atlas.h"
#include "c3de/core/platform.h"
#include "extreme_cases.h"
#include "mesh_body.h"
#include "support/catch.h"

using namespace extremes;

namespace {

constexpr double kHang = 60.0;  // s of processor time, a step

struct Grid {
  std::vector<double> moduli, ratios, steps;  // Pa, 1, s
  std::vector<std::shared_ptr<const RestState>> bodies;
  int length = 0;        // steps of a run
  double seconds = 0.0;  // processor time for a run
};

struct Scheme {
  Integrator integrator;
  const char *name;
};
constexpr Scheme kSchemes[] = {{Integrator::explicitVerlet, "explicit"},
                               {Integrator::implicitSdirk, "implicit"},
                               {Integrator::quasiStatic, "static"}};

// The guard's sentences without body, phyxel and numbers.
std::string kindOf(const std::string &report) {
  for (const char *kind : {"the stable step has fallen", "the energy has grown", "is not finite"})
    if (report.find(kind) != std::string::npos) return kind;
  const std::size_t colon = report.find(": ");
  const std::string quantity = colon == std::string::npos ? report : report.substr(colon + 2);
  return quantity.substr(0, std::min(quantity.find(" ("), quantity.find(';')));
}

AtlasRun fallAndPull(const std::shared_ptr<const RestState> &rest, double youngs, double poisson, double dt,
                     const Scheme &scheme, int steps, double seconds) {
  AtlasRun run;
  run.youngsModulus = youngs;
  run.poissonRatio = poisson;
  run.spacing = rest->spacing;
  run.scheme = scheme.name;
  run.dt = dt;
  const Material material = rubber(youngs, poisson);
  if (const auto valid = validate(material); !valid) {
    run.ending = Ending::refused;
    run.reason = valid.error();
    return run;
  }
  Simulator simulator;
  simulator.setWorld({.gravity = Vec3(0, -9.81, 0), .integrator = scheme.integrator, .dt = dt, .loadSteps = 3});
  const std::size_t id = simulator.addBody(shapes::makeBody(rest, {material}, "liver"));
  simulator.addObstacle(shapes::solidBox(Vec3(-1, -0.1, -1), Vec3(1, 0, 1), 0.3));
  Body &body = *simulator.body(id);
  if (scheme.integrator != Integrator::quasiStatic) {
    body.setInitialVelocity(Vec3(0, -0.5, 0), Vec3(1, 0, 2));
    // By the highest phyxel, sideways, with three times its weight.
    const auto highest = std::max_element(rest->positions.begin(), rest->positions.end(),
                                          [](const Vec3 &a, const Vec3 &b) { return a[1] < b[1]; });
    const Grab grab{.phyxels = {static_cast<Index>(highest - rest->positions.begin())},
                    .weights = {1.0},
                    .target = rest->origin + *highest + Vec3(0.1, 0.1, 0.1),
                    .maxForce = 3.0 * 9.81 * body.totalMass()};
    simulator.stepper().setGrab(id, grab);
  }
  const double start = c3de::processorTime_s();
  bool good = true;
  while (good && run.steps < steps && !simulator.finished() && run.seconds < seconds) {
    const double before = c3de::processorTime_s();
    good = simulator.step().has_value();
    run.slowestStep = std::max(run.slowestStep, c3de::processorTime_s() - before);
    run.seconds = c3de::processorTime_s() - start;
    run.steps += good ? 1 : 0;
  }
  const bool reported = Contains("phyxel").match(body.stopMessage()) && Contains("Help").match(body.stopMessage()) &&
                        told(simulator, "stopped");
  if (run.slowestStep > kHang) {
    run.reason = "a step took " + text(run.slowestStep) + " s";
  } else if (!finite(body)) {
    run.reason = "numbers that are none";
  } else if (!good) {
    run.ending = reported ? Ending::stopped : Ending::failed;
    run.reason = reported ? kindOf(body.stopMessage()) : "a stop without a report";
  } else if (body.stopped) {
    run.reason = "a stop that step() does not tell of";
  } else {
    run.ending = run.steps == steps || simulator.finished() ? Ending::finite : Ending::finiteSoFar;
  }
  return run;
}

std::vector<AtlasRun> sweep(const Grid &grid) {
  std::vector<AtlasRun> runs;
  for (const auto &rest : grid.bodies)
    for (const Scheme &scheme : kSchemes)
      for (const double dt : scheme.integrator == Integrator::quasiStatic ? std::vector<double>{0.0} : grid.steps) {
        const double before = c3de::processorTime_s();
        for (const double youngs : grid.moduli)
          for (const double poisson : grid.ratios) {
            runs.push_back(fallAndPull(rest, youngs, poisson, dt, scheme, grid.length, grid.seconds));
            const AtlasRun &run = runs.back();
            INFO(atlasTable({run}));
            CHECK(run.ending != Ending::failed);
          }
        std::cout << "spacing " << rest->spacing << " m, " << scheme.name << ", dt " << dt
                  << " s: " << c3de::processorTime_s() - before << " s" << std::endl;
      }
  return runs;
}

void tell(const std::string &name, const std::vector<AtlasRun> &runs) {
  const auto count = [&](Ending ending) {
    return std::count_if(runs.begin(), runs.end(), [ending](const AtlasRun &run) { return run.ending == ending; });
  };
  double slowest = 0.0;
  for (const AtlasRun &run : runs) slowest = std::max(slowest, run.slowestStep);
  const std::string result = std::to_string(runs.size()) + " runs: " + std::to_string(count(Ending::finite)) +
                             " finite to the end, " + std::to_string(count(Ending::finiteSoFar)) + " finite so far, " +
                             std::to_string(count(Ending::stopped)) + " stopped with a report, " +
                             std::to_string(count(Ending::refused)) + " refused, " +
                             std::to_string(count(Ending::failed)) + " failed";
  row(name, result);
  std::cout << name << ": " << result << "; slowest step " << slowest << " s\n";
}

std::shared_ptr<const RestState> built(const BodyShape &shape, double spacing) {
  return shapes::restState(shape, {.sampling = {.spacing = spacing}});
}

}  // namespace

TEST_CASE("whatever modulus, ratio, step and integrator: finite or stopped with a report (corners of the grid)") {
  const BodyShape shape = shapes::box(Vec3(0, 1e-4, 0), Vec3(kEdge, kEdge + 1e-4, kEdge), 4);
  const Grid grid{{1.0, 2e10}, {0.0, 0.4999}, {1e-6, 1e-3, 0.1}, {built(shape, 0.02)}, 8, 20.0};
  const std::vector<AtlasRun> runs = sweep(grid);
  CHECK(runs.size() == 28);
  tell("sweep: E {1 Pa, 20 GPa} × ν {0, 0.4999} × dt × integrators", runs);
  // The picture: outside the legend, the area of a colour is proportional to the number of runs with that outcome.
  const c3de::render::Image picture = drawAtlas(runs);
  const auto pixelsOf = [&](Ending ending) {
    int count = 0;
    for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3)
      count += std::equal(picture.rgb.begin() + static_cast<std::ptrdiff_t>(i),
                          picture.rgb.begin() + static_cast<std::ptrdiff_t>(i + 3), colourOf(ending).begin())
                   ? 1
                   : 0;
    return count;
  };
  const int legend = pixelsOf(Ending::refused);
  const auto ended = [&](Ending ending) {
    return static_cast<int>(
        std::count_if(runs.begin(), runs.end(), [ending](const AtlasRun &run) { return run.ending == ending; }));
  };
  const int finite = ended(Ending::finite), stopped = ended(Ending::stopped);
  REQUIRE(finite > 0);
  REQUIRE(stopped > 0);
  CHECK(legend > 0);
  CHECK((pixelsOf(Ending::finite) - legend) * stopped == (pixelsOf(Ending::stopped) - legend) * finite);
}

// A liver as wide as 12 spacings, and 24 cm at most: finer ones of full size have more than a million phyxels.
TEST_CASE("whatever modulus, ratio, spacing, step and integrator: finite or stopped with a report (all of the grid)",
          "[.long]") {
  std::filesystem::path file = std::filesystem::path(testDataFolder()) / "mesh/openhelp/Liver.stl";
  if (!std::filesystem::exists(file)) file = std::filesystem::path(testResourcesFolder()) / "meshes/organ.obj";
  Grid grid{{1.0, 1e2, 1e4, 1e6, 1e8, 2e10}, {0.0, 0.3, 0.45, 0.4999}, {1e-6, 1e-4, 1e-2, 0.1}, {}, 30, 2.0};
  for (const double spacing : {1e-3, 1e-2, 5e-2}) {
    grid.bodies.push_back(
        built(validation::meshShape(file, c3de::geometry::LengthUnit::millimetre, std::min(0.24, 12.0 * spacing), 5e-6),
              spacing));
    std::cout << "spacing " << spacing << " m: " << grid.bodies.back()->phyxelCount() << " phyxels\n";
  }
  const std::vector<AtlasRun> runs = sweep(grid);
  tell("sweep: E 1 Pa … 20 GPa × ν 0 … 0.4999 × spacing 1 mm … 5 cm × dt 1 µs … 0.1 s × integrators, a liver", runs);
  std::map<std::string, int> reasons;
  for (const AtlasRun &run : runs)
    if (!run.reason.empty()) ++reasons[run.reason];
  for (const auto &[reason, count] : reasons) std::cout << "  " << count << " x " << reason << '\n';
  if (const char *picture = std::getenv("C3DE_ATLAS")) {
    const auto written = c3de::render::writePng(std::string(picture) + ".png", drawAtlas(runs));
    if (!written) FAIL(written.error().message);
    std::ofstream(std::string(picture) + ".csv", std::ios::binary) << atlasTable(runs);
  }
}
