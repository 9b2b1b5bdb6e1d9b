// SPDX-License-Identifier: Apache-2.0
// Compares the error estimate of the strains of a body with the true error.
//
//   bench_error [--finest CELLS] [--only TEXT] [--csv FILE] [--json FILE]
//
// Static problems, each solved at several spacings by every layout of the lattice, and by one evaluation per phyxel;
// and once on a fine lattice (--finest cells over the thickness), which is the reference solution. The strain of a
// solution is the strain in its energy: on a lattice linear within each cell by its modes, in a cloud constant around
// each phyxel.
//
//   true error = |strain of the solution - strain of the fine one| / |strain of the fine one|   in the energy norm
//   effectivity = estimate / true error
//
// Energies are compared too: the error of the energy is of the order of the square of the true error.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "pointbased/error_estimate.h"
#include "pointbased/simulator.h"
#include "shapes.h"
#include "solution_strains.h"
#include "surfaces.h"

namespace {

using namespace pointbased;

using bench::processor_ms;
using solution_strains::energyOf;
using solution_strains::samplesOf;
using solution_strains::strainsAt;

BodyShape boxShape(const Vec3 &min, const Vec3 &max) {
  BodyShape shape = shapes::box(min, max);
  shape.surface = shapes::boxSurface(min, max);
  return shape;
}

/// About the origin, with a surface of latitudes and longitudes.
BodyShape ballShape(double radius) {
  BodyShape shape = shapes::ball(Vec3::Zero(), radius);
  shape.surface = shapes::ballSurface(Vec3::Zero(), radius, 48);
  return shape;
}

struct Problem {
  std::string name;
  BodyShape shape;
  double thickness = 0.0;  // m
  std::vector<Fix> fixes;
  std::vector<Load> loads;
  double poissonRatio = 0.3;
  std::vector<int> layers;
  int finest = 16;
};

Fix held(const Region &region, const Vec3 &displacement = Vec3::Zero(), const Vec3 &rotation_deg = Vec3::Zero()) {
  Fix fix;
  fix.region = region;
  fix.displacement = displacement;
  fix.rotation_deg = rotation_deg;
  return fix;
}

std::vector<Problem> problems(int finest) {
  const BodyShape beam = boxShape(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  const BodyShape cube = boxShape(Vec3::Zero(), Vec3::Constant(0.1));
  const Region left = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()};
  const Region right = HalfSpaceRegion{Vec3(0.2, 0, 0), -Vec3::UnitX()};
  const Region bottom = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitZ()};
  const Region top = HalfSpaceRegion{Vec3(0, 0, 0.1), -Vec3::UnitZ()};
  Load shear;
  shear.region = right;
  shear.force = Vec3(0, 0, -1.6e-3);
  Fix twisting = held(right, Vec3::Zero(), Vec3(30, 0, 0));
  twisting.centre = Vec3(0.2, 0.02, 0.02);
  Load push;  // sideways, on the cap
  push.region = HalfSpaceRegion{Vec3(0, 0, 0.03), -Vec3::UnitZ()};
  push.force = Vec3(0, 1.0, 0);
  const int fine = std::max(4, finest);
  std::vector<Problem> out;
  out.push_back({"bending", beam, 0.04, {held(left)}, {shear}, 0.3, {3, 5, 8}, fine});
  out.push_back({"bending, nu 0.45", beam, 0.04, {held(left)}, {shear}, 0.45, {3, 5}, fine});
  out.push_back({"twist by 30 degrees", beam, 0.04, {held(left), twisting}, {}, 0.3, {3, 5, 8}, fine});
  out.push_back(
      {"bonded cube, -10 %", cube, 0.1, {held(bottom), held(top, Vec3(0, 0, -0.01))}, {}, 0.3, {4, 6, 8}, 2 * fine});
  out.push_back({"indentation",
                 cube,
                 0.1,
                 {held(bottom), held(BoxRegion{Vec3(0.03, 0.03, 0.1), Vec3(0.07, 0.07, 0.1)}, Vec3(0, 0, -0.005))},
                 {},
                 0.3,
                 {5, 8, 10},
                 2 * fine});
  out.push_back({"half ball", ballShape(0.05), 0.05, {held(bottom)}, {push}, 0.3, {3, 5, 8}, fine});
  return out;
}

struct Layout {
  std::string name;
  Evaluation evaluation = Evaluation::stressPoints;
  double shift = 0.0;  // in spacings
  Mat3 axes = Mat3::Identity();
};

std::vector<Layout> layouts() {
  const Mat3 turned =
      (Eigen::AngleAxisd(0.35, Vec3::UnitX()) * Eigen::AngleAxisd(0.5, Vec3::UnitY())).toRotationMatrix();
  return {{"aligned"},
          {"offset", Evaluation::stressPoints, 0.3},
          {"turned", Evaluation::stressPoints, 0.0, turned},
          {"phyxels", Evaluation::phyxels}};
}

struct Solution {
  std::unique_ptr<Simulator> simulator;
  std::size_t id = 0;
  bool good = false;
  double ms = 0.0;
  [[nodiscard]] const Body &body() const { return *simulator->body(id); }
  [[nodiscard]] Body &body() { return *simulator->body(id); }
};

Solution solve(const Problem &problem, const Layout &layout, int layers) {
  const double spacing = problem.thickness / layers;
  BodyShape shape = problem.shape;
  // The lattice is centred on the bounds: wider bounds shift it.
  if (layout.shift > 0.0) shape.max += Vec3::Constant(2.0 * layout.shift * spacing);
  BodyRecipe recipe;
  recipe.evaluation = layout.evaluation;
  recipe.sampling.spacing = spacing;
  recipe.sampling.axes = layout.axes;
  recipe.fixes = problem.fixes;
  recipe.loads = problem.loads;
  const double begin = processor_ms();
  auto rest = buildRestState(shape, recipe, {}, serialFor());
  if (!rest) {
    std::fprintf(stderr, "bench_error: %s\n", rest.error().c_str());
    return {};
  }
  Material material;
  material.youngsModulus = 1e4;
  material.poissonRatio = problem.poissonRatio;
  const double control = layout.evaluation == Evaluation::stressPoints ? kLatticeStabilisation : kCloudStabilisation;
  Solution out;
  out.simulator = std::make_unique<Simulator>();
  WorldSettings world;
  world.integrator = Integrator::quasiStatic;
  world.loadSteps = 4;
  out.simulator->setWorld(world);
  out.id = out.simulator->addBody(
      std::make_unique<Body>(problem.name, *rest, Constitution{{material}, control}, serialFor()));
  out.good = true;
  while (out.good && !out.simulator->finished()) out.good = out.simulator->step().has_value();
  out.good = out.good && !out.body().stopped;
  for (const SimulationEvent &event : out.simulator->diagnostics().events())
    std::printf("%s, %s, %d layers: %s\n", problem.name.c_str(), layout.name.c_str(), layers, event.text.c_str());
  out.body().computeGradients(serialFor());
  out.ms = processor_ms() - begin;
  return out;
}

}  // namespace

int main(int argc, char **argv) {
  int finest = 16;
  std::string only;
  bench::CommandLine line("bench_error");
  line.add("--finest", "CELLS", [&](const std::string &text) { finest = std::atoi(text.c_str()); });
  line.add("--only", "TEXT", [&](const std::string &text) { only = text; });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  bench::Report report(line.name(), line.options());
  report.fact("finest", finest);
  report.table("errors", {{"problem", "problem             "},
                          {"lattice", "lattice"},
                          {"layers", "layers"},
                          {"phyxels", "phyxels"},
                          {"energy_error_percent", "energy %", 2},
                          {"true_error_percent", "true %", 2},
                          {"estimate_percent", "estim. %", 2},
                          {"effectivity", "effect.", 2},
                          {"stabilisation_share_percent", "stab. %", 2},
                          {"estimate_ms", "estim. ms"},
                          {"force_ms", "force ms"}});
  for (const Problem &problem : problems(finest)) {
    if (problem.name.find(only) == std::string::npos) continue;
    const Solution fine = solve(problem, layouts()[0], problem.finest);
    if (!fine.good) return 1;
    const RestState &truth = fine.body().rest();
    const auto [points, volumes] = samplesOf(truth);
    const std::vector<Mat3> strains = strainsAt(fine.body(), points);
    double total = 0.0;
    for (std::size_t p = 0; p < points.size(); ++p) total += volumes[p] * energyOf(fine.body().material(), strains[p]);
    const ElasticEnergy fineEnergy = fine.body().elasticEnergy();
    report.note(problem.name + ": the truth, " + std::to_string(problem.finest) + " layers, " +
                std::to_string(truth.phyxelCount()) + " phyxels, solved in " +
                std::to_string(std::lround(1e-3 * fine.ms)) + " s");
    for (const Layout &layout : layouts())
      for (const int layers : problem.layers) {
        Solution solution = solve(problem, layout, layers);
        if (!solution.good) {
          report.note(problem.name + ", " + layout.name + ", " + std::to_string(layers) + " layers: NOT SOLVED");
          continue;
        }
        Body &body = solution.body();
        const std::vector<Mat3> here = strainsAt(body, points);
        double difference = 0.0;
        for (std::size_t p = 0; p < points.size(); ++p)
          difference += volumes[p] * energyOf(body.material(), here[p] - strains[p]);
        const double trueError = std::sqrt(difference / total);
        ErrorScratch scratch;
        std::vector<double> perPhyxel;
        const ErrorEstimate estimate = estimateError(body, &perPhyxel, scratch, serialFor());
        constexpr int kRepeats = 5;
        double begin = processor_ms();
        for (int r = 0; r < kRepeats; ++r) (void)estimateError(body, &perPhyxel, scratch, serialFor());
        const double estimate_ms = (processor_ms() - begin) / kRepeats;
        begin = processor_ms();
        for (int r = 0; r < kRepeats; ++r) bench::evaluateForces(body, serialFor());
        const double force_ms = (processor_ms() - begin) / kRepeats;
        const ElasticEnergy energy = body.elasticEnergy();
        const double energyError =
            (energy.strain + energy.stabilisation) / (fineEnergy.strain + fineEnergy.stabilisation) - 1.0;
        report.row({problem.name, layout.name, layers, body.rest().phyxelCount(), 100.0 * energyError,
                    100.0 * trueError, 100.0 * estimate.relative, estimate.relative / trueError,
                    100.0 * estimate.stabilisationShare, estimate_ms, force_ms});
      }
  }
  return report.write();
}
