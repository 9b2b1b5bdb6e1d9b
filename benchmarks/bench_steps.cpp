// SPDX-License-Identifier: Apache-2.0
// Measures steps.
//
//   bench_steps newton   preconditioners of Newton's method by size, shape and stiffness
//   bench_steps balls    contact between the skins of four balls
//   bench_steps sheet    self-contact of a folded sheet
//   bench_steps pressed  explicit and implicit steps of two blocks pressed together
//
// newton: bodies of the simulator, cells cut by their skins: a box of 0.2 x 0.04 x 0.04 m, a liver, a kidney and a tube
// by formulas, fixed at the lowest eighth of their longest axis; a beam: that box on whole cells, fixed at its end face.
//   rest   a quasi-static solution under gravity across the axis, that bends a box of 10 kPa by a fifth of its length
//          and grows with the modulus; one load step
//   first  a step of backward Euler, dt = 1/60 s, from rest under 9.81 m/s²
//   step   the mean of five more
//   swing  the mean of thirty of backward Euler from rest, and as many of SDIRK2 ("sdirk"): a beam of 10 kPa comes to
//          hang by its held end, is stretched to twice its length there, and swings back
// Linear iterations are per linear solve; evaluations: what the steps cost in evaluations of the forces of the body.
// Times are of the processor, one thread, so what else the machine does counts little.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "bench/bodies.h"
#include "mesh_body.h"
#include "steps/questions.h"

namespace {

using namespace pointbased;

using bench::Options;
using bench::processor_ms;
using bench::Report;

struct Case {
  std::string body;
  double youngsModulus = 0.0, poissonRatio = 0.0;
  Preconditioner preconditioner = Preconditioner::automatic;
  std::string name;  ///< of the preconditioner
};

/// Bodies of one shape and size.
struct Filled {
  BodyShape shape;
  std::shared_ptr<const RestState> rest;
  double height = 0.0;  ///< m, along the longest axis

  Filled(const std::string &body, double phyxels) : shape(validation::meshShape(bench::surfaceNamed(body))) {
    BodyRecipe recipe;
    Fix fix =
        bench::heldIn(HalfSpaceRegion{shape.min + 0.125 * (shape.max - shape.min)[0] * Vec3::UnitX(), Vec3::UnitX()});
    recipe.sampling.count = static_cast<std::size_t>(phyxels);
    if (body == "beam") {
      fix.region = BoxRegion{Vec3(-1e-7, -1.0, -1.0), Vec3(1e-7, 1.0, 1.0)};
      recipe.sampling.spacing = 0.04 / std::floor(std::cbrt(phyxels / 5.0));
    }
    recipe.fixes.push_back(fix);
    rest = bench::valueOf(buildRestState(shape, recipe, {}, serialFor()));
    height = (shape.max - shape.min)[0];
  }
};

std::unique_ptr<Body> bodyOf(const Filled &filled, const Case &of) {
  return std::make_unique<Body>(of.body, filled.rest, bench::elastic(of.youngsModulus, of.poissonRatio), serialFor());
}

/// ms of one evaluation of the forces, as in an explicit substep.
double evaluation_ms(Body &body) {
  body.evaluate(0.0, 0.0, serialFor());
  const int n = std::max(3, static_cast<int>(2e5 / static_cast<double>(body.rest().phyxelCount())));
  const double begin = processor_ms();
  for (int k = 0; k < n; ++k) body.evaluate(0.0, 0.0, serialFor());
  return (processor_ms() - begin) / n;
}

double tipOf(const Body &body) {
  double most = 0.0;
  for (const Vec3 &u : body.state().displacements) most = std::max(most, u.norm());
  return most;
}

double largestStretchOf(const Body &body) {
  std::vector<Mat3> gradients(body.rest().pointCount());
  deformationGradients(body.rest().stencils, body.state().displacements, gradients, serialFor());
  double most = 0.0;
  for (const Mat3 &F : gradients)
    most =
        std::max(most, Eigen::SelfAdjointEigenSolver<Mat3>(F.transpose() * F, Eigen::EigenvaluesOnly).eigenvalues()[2]);
  return std::sqrt(most);
}

/// A body with what its steps need.
struct Stepped {
  Stepped(const Filled &filled, const Case &solved, const Vec3 &gravity)
      : of(solved), body(bodyOf(filled, of)), evaluation(evaluation_ms(*body)) {
    env.gravity = gravity;
    env.preconditioner = of.preconditioner;
    env.parallelFor = &serial;
    env.clock = &clock;
  }
  /// Adds the iterations of a step to the sum. @return whether it was solved
  bool add(const ImplicitResult &result) {
    sum.iterations += result.newton.iterations;
    sum.linearIterations += result.newton.linearIterations;
    sum.factorisations += result.newton.factorisations;
    failure = result.failure;
    return failure.empty();
  }
  /// Reports the mean of `steps` steps since the last row.
  void report(const char *name, int steps, Report &report) {
    const double per = steps, ms = processor_ms() - begin_ms;
    report.row({of.body, of.name, body->rest().phyxelCount(), of.youngsModulus, of.poissonRatio, name,
                sum.iterations / per, static_cast<double>(sum.linearIterations) / std::max(1, sum.iterations),
                sum.factorisations / per, ms / per, ms / per / evaluation, 1e3 * tipOf(*body), largestStretchOf(*body),
                failure});
    sum = {};
    begin_ms = processor_ms();
  }

  const Case &of;
  std::unique_ptr<Body> body;
  double evaluation = 0.0;
  const ParallelFor serial = serialFor();
  StageClock clock{stageNames()};
  Environment env;
  NewtonSolver solver;
  NewtonResult sum;
  std::string failure;
  double begin_ms = processor_ms();
};

void solveRest(const Filled &filled, const Case &of, Report &report) {
  // ρ g bends a box of 0.2 m by a fifth of its length at 10 kPa; other bodies by about the same part of their length.
  const double slender = 0.2 / filled.height * (of.body == "box" || of.body == "tube" ? 1.0 : 2.0);
  Stepped stepped(filled, of, Vec3(0, 0, -0.5 * slender * of.youngsModulus / 1e4));
  stepped.body->quasiStatic = true;
  stepped.add(quasiStaticStep(*stepped.body, stepped.solver, stepped.env, 0.0, 1.0));
  stepped.report("rest", 1, report);
}

/// @param first  the first step is reported alone
void solveSteps(const Filled &filled, const Case &of, const char *name, int steps, bool first, Integrator integrator,
                Report &report) {
  constexpr double kDt = 1.0 / 60.0;
  Stepped stepped(filled, of, Vec3(0, 0, -9.81));
  const int all = first ? steps + 1 : steps;
  for (int k = 0; k < all; ++k) {
    const bool solved = stepped.add(implicitStep(*stepped.body, stepped.solver, stepped.env, k * kDt, kDt, integrator));
    if (first && k == 0) stepped.report("first", 1, report);
    if (!solved) break;
  }
  stepped.report(name, steps, report);
}

struct Choice {
  Preconditioner preconditioner;
  const char *name;
};
constexpr Choice kPreconditioners[] = {{Preconditioner::blockJacobi, "block_jacobi"},
                                       {Preconditioner::incomplete, "incomplete"},
                                       {Preconditioner::factorised, "factorised"},
                                       {Preconditioner::multigrid, "multigrid"},
                                       {Preconditioner::automatic, "auto"}};

std::vector<double> numbersOf(const Options &options, const std::string &option, std::vector<double> usual) {
  std::vector<double> given;
  for (const std::string &text : options.texts(option)) given.push_back(std::stod(text));
  return given.empty() ? usual : given;
}

Choice choiceOf(const std::string &name) {
  for (const Choice &choice : kPreconditioners)
    if (name == choice.name) return choice;
  throw std::invalid_argument("there is no preconditioner '" + name +
                              "'; accepted: block_jacobi, incomplete, factorised, multigrid, auto");
}

void comparePreconditioners(const Options &options, Report &report) {
  const std::string only = options.text("--case");
  std::vector<std::string> bodies = options.texts("--body"), names = options.texts("--preconditioner");
  if (bodies.empty()) bodies = {"box", "liver"};
  if (names.empty()) names = {"multigrid", "auto"};
  report.table("solves",
               "body; preconditioner; phyxels; youngs_modulus_Pa=E Pa:0; poisson_ratio=nu:4; case; "
               "newton_iterations=newton:1; linear_iterations=linear:1; factorisations=renewed:1; processor_ms=ms:2; "
               "evaluations:1; tip_mm=tip mm; largest_stretch=stretch:2; failure");
  for (const std::string &body : bodies)
    for (const double size : numbersOf(options, "--phyxels", {500.0, 3000.0, 10'000.0})) {
      const Filled filled(body, size);
      for (const double E : numbersOf(options, "--modulus", {1e4, 1e6}))
        for (const double nu : numbersOf(options, "--poisson", {0.3, 0.45, 0.49}))
          for (const std::string &name : names) {
            const Case of{body, E, nu, choiceOf(name).preconditioner, name};
            if (only.empty() || only == "rest") solveRest(filled, of, report);
            if (only.empty() || only == "step")
              solveSteps(filled, of, "step", 5, true, Integrator::backwardEuler, report);
            if (!only.empty() && only != "swing") continue;
            solveSteps(filled, of, "swing", 30, false, Integrator::backwardEuler, report);
            solveSteps(filled, of, "sdirk", 30, false, Integrator::implicitSdirk, report);
          }
    }
}

}  // namespace

int main(int argc, char **argv) {
  return bench::run(
      "bench_steps",
      {{"newton", "[--phyxels N] [--body NAME] [--modulus PA] [--poisson NU] [--preconditioner NAME] [--case NAME]",
        comparePreconditioners},
       {"balls", "[--phyxels N]", bench::measureBalls},
       {"sheet", "", bench::measureSheet},
       {"pressed", "", bench::measurePressed}},
      argc, argv);
}
