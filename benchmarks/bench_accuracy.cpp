// SPDX-License-Identifier: Apache-2.0
// Compares estimated and predicted errors with true ones.
//
//   bench_accuracy error   the error estimate of the strains of a body
//   bench_accuracy dial    the predictions of the accuracy setting
//   bench_accuracy organs  the predicted errors of organs at the default sampling
//
// error: static problems, each solved at several spacings by every layout of the lattice, and by one evaluation per
// phyxel; and once on a fine lattice (--finest cells over the thickness), which is the reference solution. The strain of
// a solution is the strain in its energy: on a lattice linear within each cell by its modes, in a cloud constant around
// each phyxel.
//
//   true error = |strain of the solution - strain of the fine one| / |strain of the fine one|   in the energy norm
//   effectivity = estimate / true error
//
// Energies are compared too: the error of the energy is of the order of the square of the true error.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "accuracy/questions.h"
#include "bench/bodies.h"
#include "bench/timing.h"
#include "pointbased/error_estimate.h"
#include "shapes.h"
#include "solution_strains.h"
#include "surfaces.h"

namespace {

using namespace pointbased;

using bench::heldIn;
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
  Fix twisting = heldIn(right);
  twisting.rotation_deg = Vec3(30, 0, 0);
  twisting.centre = Vec3(0.2, 0.02, 0.02);
  Load push;  // sideways, on the cap
  push.region = HalfSpaceRegion{Vec3(0, 0, 0.03), -Vec3::UnitZ()};
  push.force = Vec3(0, 1.0, 0);
  const int fine = std::max(4, finest);
  std::vector<Problem> out;
  out.push_back({"bending", beam, 0.04, {heldIn(left)}, {shear}, 0.3, {3, 5, 8}, fine});
  out.push_back({"bending, nu 0.45", beam, 0.04, {heldIn(left)}, {shear}, 0.45, {3, 5}, fine});
  out.push_back({"twist by 30 degrees", beam, 0.04, {heldIn(left), twisting}, {}, 0.3, {3, 5, 8}, fine});
  out.push_back({"bonded cube, -10 %",
                 cube,
                 0.1,
                 {heldIn(bottom), heldIn(top, Vec3(0, 0, -0.01))},
                 {},
                 0.3,
                 {4, 6, 8},
                 2 * fine});
  out.push_back({"indentation",
                 cube,
                 0.1,
                 {heldIn(bottom), heldIn(BoxRegion{Vec3(0.03, 0.03, 0.1), Vec3(0.07, 0.07, 0.1)}, Vec3(0, 0, -0.005))},
                 {},
                 0.3,
                 {5, 8, 10},
                 2 * fine});
  out.push_back({"half ball", ballShape(0.05), 0.05, {heldIn(bottom)}, {push}, 0.3, {3, 5, 8}, fine});
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
  std::unique_ptr<bench::World> world;
  double ms = 0.0;
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
  Constitution constitution = bench::elastic(1e4, problem.poissonRatio);
  if (layout.evaluation != Evaluation::stressPoints) constitution.stabilisation = kCloudStabilisation;
  WorldSettings settings;
  settings.integrator = Integrator::quasiStatic;
  settings.loadSteps = 4;
  auto rest = bench::valueOf(buildRestState(shape, recipe, {}, serialFor()));
  auto world = std::make_unique<bench::World>(
      std::make_unique<Body>(problem.name, std::move(rest), std::move(constitution), serialFor()), settings);
  world->solve();
  for (const SimulationEvent &event : world->simulator.diagnostics().events())
    std::printf("%s, %s, %d layers: %s\n", problem.name.c_str(), layout.name.c_str(), layers, event.text.c_str());
  world->body().computeGradients(serialFor());
  return {std::move(world), processor_ms() - begin};
}

double timeOf(const std::function<void()> &f) {
  constexpr int kRepeats = 5;
  const double begin = processor_ms();
  for (int r = 0; r < kRepeats; ++r) f();
  return (processor_ms() - begin) / kRepeats;
}

void compareEstimates(const bench::Options &options, bench::Report &report) {
  const int finest = static_cast<int>(options.number("--finest", 16));
  report.fact("finest", finest);
  report.table("errors",
               "problem; lattice; layers; phyxels; energy_error_percent=energy %:2; true_error_percent=true %:2; "
               "estimate_percent=estim. %:2; effectivity=effect.:2; stabilisation_share_percent=stab. %:2; "
               "estimate_ms=estim. ms; force_ms=force ms");
  for (const Problem &problem : problems(finest)) {
    if (problem.name.find(options.text("--only")) == std::string::npos) continue;
    const Solution fine = solve(problem, layouts()[0], problem.finest);
    const Body &reference = fine.world->body();
    const auto [points, volumes] = samplesOf(reference.rest());
    const std::vector<Mat3> strains = strainsAt(reference, points);
    double total = 0.0;
    for (std::size_t p = 0; p < points.size(); ++p) total += volumes[p] * energyOf(reference.material(), strains[p]);
    const ElasticEnergy fineEnergy = reference.elasticEnergy();
    report.note(problem.name + ": the truth, " + std::to_string(problem.finest) + " layers, " +
                std::to_string(reference.rest().phyxelCount()) + " phyxels, solved in " +
                std::to_string(std::lround(1e-3 * fine.ms)) + " s");
    for (const Layout &layout : layouts())
      for (const int layers : problem.layers) try {
          const Solution solution = solve(problem, layout, layers);
          Body &body = solution.world->body();
          const std::vector<Mat3> here = strainsAt(body, points);
          double difference = 0.0;
          for (std::size_t p = 0; p < points.size(); ++p)
            difference += volumes[p] * energyOf(body.material(), here[p] - strains[p]);
          const double trueError = std::sqrt(difference / total);
          ErrorScratch scratch;
          std::vector<double> perPhyxel;
          const ErrorEstimate estimate = estimateError(body, &perPhyxel, scratch, serialFor());
          const double estimate_ms = timeOf([&] { (void)estimateError(body, &perPhyxel, scratch, serialFor()); });
          const double force_ms = timeOf([&] { bench::evaluateForces(body, serialFor()); });
          const ElasticEnergy energy = body.elasticEnergy();
          const double energyError =
              (energy.strain + energy.stabilisation) / (fineEnergy.strain + fineEnergy.stabilisation) - 1.0;
          report.row({problem.name, layout.name, layers, body.rest().phyxelCount(), 100.0 * energyError,
                      100.0 * trueError, 100.0 * estimate.relative, estimate.relative / trueError,
                      100.0 * estimate.stabilisationShare, estimate_ms, force_ms});
        } catch (const std::runtime_error &error) {
          report.note(problem.name + ", " + layout.name + ", " + std::to_string(layers) +
                      " layers: NOT SOLVED: " + error.what());
        }
  }
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run("bench_accuracy",
                    {{"error", "[--finest CELLS] [--only TEXT]", compareEstimates},
                     {"dial",
                      "[--first SEED] [--problems N] [--fit PROBLEMS] [--second-order] [--orders PROBLEMS] [--adaptive "
                      "PROBLEMS] [--finest PHYXELS]",
                      bench::checkPredictions},
                     {"organs", "[--mesh FILE] [--only TEXT] [--phyxels N]", bench::checkOrgans}},
                    argc, argv);
}
