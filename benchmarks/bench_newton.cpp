// SPDX-License-Identifier: Apache-2.0
// Compares preconditioners of Newton's method by size, shape and stiffness.
//
//   bench_newton [--phyxels N]... [--body NAME] [--modulus PA] [--poisson NU] [--preconditioner NAME] [--case NAME]
//                [--csv FILE] [--json FILE]
//
// Bodies of the simulator, cells cut by their skins: a box of 0.2 x 0.04 x 0.04 m, a liver, a kidney and a tube by
// formulas, fixed at the lowest eighth of their longest axis; a beam: that box on whole cells, fixed at its end face.
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
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/report.h"
#include "bench/timing.h"
#include "mesh_body.h"
#include "pointbased/simulator.h"
#include "surfaces.h"
#include "thin_shapes.h"

namespace {

using namespace pointbased;

using bench::processor_ms;

constexpr double kPi = 3.14159265358979323846;

/// A deformed ball of unit radius.
Surface ball(const std::function<Vec3(const Vec3 &)> &moved) {
  constexpr int kRings = 24;
  return validation::latheSurface(kRings, 40, [&](int ring, double phi) {
    const double theta = kPi * ring / kRings;
    return moved(Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), -std::cos(theta)));
  });
}

Surface surfaceOf(const std::string &body) {
  if (body == "box" || body == "beam") return shapes::boxSurface(Vec3::Zero(), Vec3(0.2, 0.04, 0.04));
  if (body == "liver")
    return ball([](const Vec3 &n) {
      return Vec3(0.11 * n[0], (0.045 + 0.03 * n[0]) * n[1] + 0.02 * n[0] * n[0], (0.07 - 0.03 * n[0] * n[0]) * n[2]);
    });
  if (body == "kidney")
    return ball([](const Vec3 &n) { return Vec3(0.06 * n[0], 0.028 * n[1] + 0.025 * n[0] * n[0], 0.022 * n[2]); });
  if (body == "tube") return validation::tubeSurface(0.012, 0.004, 0.12);
  throw std::runtime_error("there is no body '" + body + "'; accepted: box, beam, liver, kidney, tube");
}

struct Case {
  std::string body;
  double phyxels = 0.0, youngsModulus = 0.0, poissonRatio = 0.0;
  Preconditioner preconditioner = Preconditioner::automatic;
  std::string name;  ///< of the preconditioner
};

/// Bodies of one shape and size.
struct Filled {
  BodyShape shape;
  std::shared_ptr<const RestState> rest;
  double height = 0.0;  ///< m, along the longest axis
  double fill_ms = 0.0;

  Filled(const std::string &body, double phyxels) : shape(validation::meshShape(surfaceOf(body))) {
    BodyRecipe recipe;
    Fix fix;
    fix.region = HalfSpaceRegion{shape.min + 0.125 * (shape.max - shape.min)[0] * Vec3::UnitX(), Vec3::UnitX()};
    recipe.sampling.count = static_cast<std::size_t>(phyxels);
    if (body == "beam") {
      fix.region = BoxRegion{Vec3(-1e-7, -1.0, -1.0), Vec3(1e-7, 1.0, 1.0)};
      recipe.sampling.spacing = 0.04 / std::floor(std::cbrt(phyxels / 5.0));
    }
    recipe.fixes.push_back(fix);
    const double begin = processor_ms();
    auto filled = buildRestState(shape, recipe, {}, serialFor());
    if (!filled) throw std::runtime_error(filled.error());
    rest = *filled;
    fill_ms = processor_ms() - begin;
    height = (shape.max - shape.min)[0];
  }
};

std::unique_ptr<Body> bodyOf(const Filled &filled, const Case &of) {
  const Material material{MaterialLaw::neoHookean, of.youngsModulus, of.poissonRatio, 1060.0};
  return std::make_unique<Body>(of.body, filled.rest, Constitution{{material}, kLatticeStabilisation}, serialFor());
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

class Rows {
 public:
  explicit Rows(bench::Report &report) : report_(report) {
    report_.table("solves", {{"body", "body  "},
                             {"phyxels", "phyxels"},
                             {"youngs_modulus_Pa", "E Pa      ", 0},
                             {"poisson_ratio", "nu   ", 4},
                             {"case", "case "},
                             {"preconditioner", "precond.   "},
                             {"newton_iterations", "newton", 1},
                             {"linear_iterations", "linear", 1},
                             {"factorisations", "renewed", 1},
                             {"processor_ms", "ms      ", 2},
                             {"evaluations", "evaluations", 1},
                             {"tip_mm", "tip mm"},
                             {"largest_stretch", "stretch", 2},
                             {"failure", "failure"}});
  }
  void row(const Case &of, std::size_t phyxels, const char *name, const NewtonResult &sum, double per, double ms,
           double evaluation, const Body &body, const std::string &failure) {
    report_.row({of.body, phyxels, of.youngsModulus, of.poissonRatio, name, of.name, sum.iterations / per,
                 static_cast<double>(sum.linearIterations) / std::max(1, sum.iterations), sum.factorisations / per,
                 ms / per, ms / per / evaluation, 1e3 * tipOf(body), largestStretchOf(body), failure});
  }

 private:
  bench::Report &report_;
};

Environment environmentOf(const Case &of, const Vec3 &gravity, StageClock &clock, const ParallelFor &serial) {
  Environment env;
  env.gravity = gravity;
  env.preconditioner = of.preconditioner;
  env.parallelFor = &serial;
  env.clock = &clock;
  return env;
}

void solveRest(const Filled &filled, const Case &of, Rows &rows) {
  const auto body = bodyOf(filled, of);
  const double evaluation = evaluation_ms(*body);
  body->quasiStatic = true;
  const ParallelFor serial = serialFor();
  StageClock clock(stageNames());
  // ρ g bends a box of 0.2 m by a fifth of its length at 10 kPa; other bodies by about the same part of their length.
  const double slender = 0.2 / filled.height * (of.body == "box" || of.body == "tube" ? 1.0 : 2.0);
  const Environment env = environmentOf(of, Vec3(0, 0, -0.5 * slender * of.youngsModulus / 1e4), clock, serial);
  NewtonSolver solver;
  const double begin = processor_ms();
  const ImplicitResult result = quasiStaticStep(*body, solver, env, 0.0, 1.0);
  rows.row(of, filled.rest->phyxelCount(), "rest", result.newton, 1.0, processor_ms() - begin, evaluation, *body,
           result.failure);
}

void solveSteps(const Filled &filled, const Case &of, Rows &rows) {
  constexpr double kDt = 1.0 / 60.0;
  constexpr int kSteps = 5;
  const auto body = bodyOf(filled, of);
  const double evaluation = evaluation_ms(*body);
  const ParallelFor serial = serialFor();
  StageClock clock(stageNames());
  const Environment env = environmentOf(of, Vec3(0, 0, -9.81), clock, serial);
  NewtonSolver solver;
  NewtonResult sum;
  double ms = 0.0;
  std::string failure;
  for (int k = 0; k <= kSteps && failure.empty(); ++k) {
    const double begin = processor_ms();
    const ImplicitResult result = implicitStep(*body, solver, env, k * kDt, kDt, Integrator::backwardEuler);
    const double took = processor_ms() - begin;
    failure = result.failure;
    if (k == 0) {
      rows.row(of, filled.rest->phyxelCount(), "first", result.newton, 1.0, took, evaluation, *body, failure);
      continue;
    }
    sum.iterations += result.newton.iterations;
    sum.linearIterations += result.newton.linearIterations;
    sum.factorisations += result.newton.factorisations;
    ms += took;
  }
  rows.row(of, filled.rest->phyxelCount(), "step", sum, kSteps, ms, evaluation, *body, failure);
}

void solveSwing(const Filled &filled, const Case &of, Integrator integrator, Rows &rows) {
  constexpr double kDt = 1.0 / 60.0;
  constexpr int kSteps = 30;
  const auto body = bodyOf(filled, of);
  const double evaluation = evaluation_ms(*body);
  const ParallelFor serial = serialFor();
  StageClock clock(stageNames());
  const Environment env = environmentOf(of, Vec3(0, 0, -9.81), clock, serial);
  NewtonSolver solver;
  NewtonResult sum;
  std::string failure;
  const double begin = processor_ms();
  for (int k = 0; k < kSteps && failure.empty(); ++k) {
    const ImplicitResult result = implicitStep(*body, solver, env, k * kDt, kDt, integrator);
    failure = result.failure;
    sum.iterations += result.newton.iterations;
    sum.linearIterations += result.newton.linearIterations;
    sum.factorisations += result.newton.factorisations;
  }
  rows.row(of, filled.rest->phyxelCount(), integrator == Integrator::backwardEuler ? "swing" : "sdirk", sum, kSteps,
           processor_ms() - begin, evaluation, *body, failure);
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

constexpr const char *kAccepted = "block_jacobi, incomplete, factorised, multigrid, auto";

template <class T>
std::vector<T> orDefault(std::vector<T> chosen, std::vector<T> usual) {
  return chosen.empty() ? usual : chosen;
}

}  // namespace

int main(int argc, char **argv) {
  std::vector<double> sizes, moduli, ratios;
  std::vector<std::string> bodies, names;
  std::string only;
  bench::CommandLine line("bench_newton");
  line.add("--phyxels", "N", [&](const std::string &text) { sizes.push_back(std::atof(text.c_str())); });
  line.add("--modulus", "PA", [&](const std::string &text) { moduli.push_back(std::atof(text.c_str())); });
  line.add("--poisson", "NU", [&](const std::string &text) { ratios.push_back(std::atof(text.c_str())); });
  line.add("--body", "NAME", [&](const std::string &text) { bodies.push_back(text); });
  line.add("--preconditioner", "NAME", [&](const std::string &text) { names.push_back(text); });
  line.add("--case", "NAME", [&](const std::string &text) { only = text; });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  sizes = orDefault(sizes, {500.0, 3000.0, 10'000.0});
  moduli = orDefault(moduli, {1e4, 1e6});
  ratios = orDefault(ratios, {0.3, 0.45, 0.49});
  bodies = orDefault(bodies, {"box", "liver"});
  names = orDefault(names, {"multigrid", "auto"});
  bench::Report report(line.name(), line.options());
  Rows rows(report);
  try {
    for (const std::string &body : bodies)
      for (const double size : sizes) {
        const Filled filled(body, size);
        for (const double E : moduli)
          for (const double nu : ratios)
            for (const std::string &name : names) {
              const auto *const found = std::find_if(std::begin(kPreconditioners), std::end(kPreconditioners),
                                                     [&](const Choice &c) { return name == c.name; });
              if (found == std::end(kPreconditioners))
                throw std::runtime_error("there is no preconditioner '" + name + "'; accepted: " + kAccepted);
              const Case of{body, size, E, nu, found->preconditioner, name};
              if (only.empty() || only == "rest") solveRest(filled, of, rows);
              if (only.empty() || only == "step") solveSteps(filled, of, rows);
              if (only.empty() || only == "swing") solveSwing(filled, of, Integrator::backwardEuler, rows);
              if (only.empty() || only == "swing") solveSwing(filled, of, Integrator::implicitSdirk, rows);
            }
      }
  } catch (const std::exception &error) {
    std::fprintf(stderr, "bench_newton: %s\n", error.what());
    return 2;
  }
  return report.write();
}
