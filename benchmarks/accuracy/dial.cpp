// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "accuracy/questions.h"
#include "accuracy/random_problems.h"
#include "bench/bodies.h"
#include "bench/timing.h"
#include "pointbased/adaptive_sampling.h"

namespace {

using namespace pointbased;
using bench::Options;
using bench::Report;

constexpr std::uint64_t kHeldOut = 1000;  // first seed that nothing was fitted to
constexpr double kOrder = 1.25;           // order of the errors in the spacing, for the error of the reference itself
constexpr double kAccuracyTargets[] = {0.03, 0.05, 0.1, 0.2};

double sizeOf(const Surface &surface) {
  Vec3 low = surface.positions.front(), high = low;
  for (const Vec3 &x : surface.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).maxCoeff();
}

void scaleLoads(dial::RandomProblem &problem, double factor) {
  problem.gravity *= factor;
  for (Load &load : problem.recipe.loads) load.force *= factor;
  for (Fix &fix : problem.recipe.fixes) fix.displacement *= factor;
}

std::unique_ptr<bench::World> worldOf(const dial::RandomProblem &problem, double spacing, Integrator integrator) {
  BodyRecipe recipe = problem.recipe;
  recipe.sampling.spacing = spacing;
  WorldSettings settings;
  settings.gravity = problem.gravity;
  settings.integrator = integrator;
  settings.loadSteps = 3;
  auto body =
      std::make_unique<Body>(problem.name, bench::valueOf(buildRestState(problem.shape, recipe, {}, serialFor())),
                             problem.constitution, serialFor());
  (void)body->setFoundation(problem.foundation);
  return std::make_unique<bench::World>(std::move(body), settings);
}

/// The body at rest under its loads with its own law. Throws where there is no equilibrium.
TrialSolution solve(const dial::RandomProblem &problem, double spacing, const SurfacePoints &samples) {
  const auto world = worldOf(problem, spacing, Integrator::quasiStatic);
  world->solve();
  const RestState &rest = world->body().rest();
  TrialSolution out;
  out.spacing = rest.spacing;
  out.phyxels = rest.phyxelCount();
  out.displacements = displacementsAt(rest, world->body().state().displacements, samples, serialFor());
  for (const Vec3 &u : out.displacements) out.largest = std::max(out.largest, u.norm());
  return out;
}

/// The remaining error of the reference is added by the order of the model.
double errorOf(const TrialSolution &solved, const TrialSolution &truth) {
  const double lacking = 1.0 - std::pow(truth.spacing / solved.spacing, kOrder);
  return skinDifference(solved, truth) / truth.largest / lacking;
}

struct FrameTimes {
  double promised = 0.0, measured = 0.0;  // ms
};

/// The time per frame predicted when the body is built, and the mean wall time per frame over half a simulated second.
FrameTimes frameTimes(const dial::RandomProblem &problem, double spacing) {
  constexpr double kSimulated = 0.5;  // s
  const auto world = worldOf(problem, spacing, Integrator::explicitVerlet);
  FrameTimes out;
  out.promised = measureFrame(world->body(), world->simulator.world().settings(), {}, serialFor(), nullptr);
  while (world->simulator.time() < kSimulated) world->step();
  out.measured = 1e3 * kFrame * world->simulator.diagnostics().costOf(world->id);
  return out;
}

struct Tried {
  dial::RandomProblem problem;
  AccuracySurvey survey;
};

std::optional<Tried> tried(std::uint64_t seed, LatticeOrder order = LatticeOrder::linear) {
  Tried out{dial::randomProblem(seed), {}};
  out.problem.recipe.sampling.order = order;
  auto survey = surveyAccuracy(out.problem.problem(), serialFor());
  if (!survey) {
    std::printf("%s: not predicted: %s\n", out.problem.name.c_str(), survey.error().c_str());
    return std::nullopt;
  }
  out.survey = std::move(*survey);
  return out;
}

void checkHeldOut(Report &report, std::uint64_t first, int problems) {
  report.table("promises",
               "problem; wish_percent=wish %:0; order; phyxels; promised_percent=promised %:2; low_percent=from:2; "
               "high_percent=to:2; true_percent=true %:2; in_band=in; promised_ms=promised ms; "
               "measured_ms=measured ms; ratio:2; survey_ms=survey ms:0");
  const MachineSpeed speed = measureSpeed(serialFor(), 1);
  int inBand = 0, inTime = 0, all = 0, met = 0;
  for (std::uint64_t seed = first; all < problems && seed < first + 2 * static_cast<std::uint64_t>(problems); ++seed) {
    const double begin = bench::processor_ms();
    auto one = tried(seed);
    const double survey_ms = bench::processor_ms() - begin;
    if (!one) continue;
    auto &[problem, survey] = *one;
    // Up to the displacements that organs undergo: where they buckle or fold, the solution is not unique.
    const double factor = 0.06 * sizeOf(problem.shape.surface) / survey.largest;
    scaleLoads(problem, factor);
    survey.largest *= factor;
    const double wish = kAccuracyTargets[seed % 4];
    CostSetting setting;
    setting.speed = speed;
    setting.world.integrator = Integrator::explicitVerlet;
    const AccuracyTarget target{AccuracyTarget::Kind::share, wish};
    SamplingChoice choice = chooseSampling(survey, problem.constitution, setting, target);
    if (mayNeedSecondOrder(survey, choice, problem.constitution, target)) {
      const auto second = tried(seed, LatticeOrder::quadratic);
      if (second && second->survey.fine.quadraticPoints > 0) {
        AccuracySurvey scaled = second->survey;
        scaled.largest *= factor;
        const SamplingChoice other = chooseSampling(scaled, problem.constitution, setting, target);
        if (prefersSecondOrder(choice, other, target)) {
          choice = other;
          survey = std::move(scaled);
        }
      }
    }
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    const double fine = std::clamp(8.0 * static_cast<double>(choice.count), 3000.0, 16000.0);
    TrialSolution solved, truth;
    FrameTimes frame;
    try {
      problem.recipe.sampling.order = choice.order;
      solved = solve(problem, choice.spacing, samples);
      frame = frameTimes(problem, solved.spacing);
      problem.recipe.sampling.order = LatticeOrder::quadratic;
      truth = solve(problem, survey.spacingFor(fine), samples);
    } catch (const std::runtime_error &error) {
      report.note(problem.name + ": no equilibrium was found; left out: " + error.what());
      continue;
    }
    const double error = errorOf(solved, truth);
    const ErrorPrediction promised = predictError(survey, solved.spacing);
    const bool isIn = error >= promised.low && error <= promised.high;
    const double ratio = frame.measured / frame.promised;
    ++all;
    inBand += isIn ? 1 : 0;
    inTime += std::abs(ratio - 1.0) <= 0.25 ? 1 : 0;
    met += error <= wish ? 1 : 0;
    report.row({problem.name, 100.0 * wish, choice.order == LatticeOrder::quadratic ? 2 : 1, solved.phyxels,
                100.0 * promised.share, 100.0 * promised.low, 100.0 * promised.high, 100.0 * error, isIn ? "yes" : "NO",
                frame.promised, frame.measured, ratio, survey_ms});
  }
  report.note("errors within their band: " + std::to_string(inBand) + " of " + std::to_string(all) +
              ", wishes met: " + std::to_string(met) + ", costs within 25 %: " + std::to_string(inTime));
  report.fact("in_band", inBand);
  report.fact("costs_within_25_percent", inTime);
  report.fact("problems", all);
}

/// Errors of bodies with cells of uniform size, and with finer cells where a trial locates the error.
void compareAdaptive(Report &report, std::uint64_t first, int problems, double finest) {
  report.table("adaptive",
               "problem; wanted:0; even; even_percent=error %; dearer=1.68 x; dearer_percent=error %; adaptive; "
               "adaptive_percent=error %; share:2; halved; step:2; ratio=adaptive/even:2; "
               "ratio_dearer=adaptive/dearer:2");
  double sum = 0.0, sumDearer = 0.0;
  int n = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(problems); ++seed) {
    const dial::RandomProblem problem = dial::randomProblem(seed);
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    const auto truth = solveTrial(problem.problem(), static_cast<std::size_t>(finest), samples, serialFor());
    if (!truth) continue;
    for (const double count : {700.0, 2000.0}) {
      const auto even = solveTrial(problem.problem(), static_cast<std::size_t>(count), samples, serialFor());
      const auto dearer = solveTrial(problem.problem(), static_cast<std::size_t>(1.68 * count), samples, serialFor());
      BodyRecipe recipe = problem.recipe;
      recipe.sampling.spacing = 0.0;
      recipe.sampling.count = static_cast<std::size_t>(count);
      const AccuracyProblem wanted{problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity};
      const auto adapted = adaptSampling(wanted, serialFor());
      if (!even || !dearer || !adapted) continue;
      BodyRecipe finer = recipe;
      finer.sampling = adapted->sampling;
      const AccuracyProblem again{problem.shape, finer, problem.constitution, problem.foundation, problem.gravity};
      const auto solved = solveTrial(again, samples, serialFor());
      if (!solved) {
        std::printf("%s: %s\n", problem.name.c_str(), solved.error().c_str());
        continue;
      }
      const auto error = [&](const TrialSolution &of) { return 100.0 * skinDifference(of, *truth) / truth->largest; };
      report.row({problem.name, count, even->phyxels, error(*even), dearer->phyxels, error(*dearer), solved->phyxels,
                  error(*solved), adapted->share, adapted->halved, solved->stableStep / even->stableStep,
                  error(*solved) / error(*even), error(*solved) / error(*dearer)});
      sum += std::log(error(*solved) / error(*even));
      sumDearer += std::log(error(*solved) / error(*dearer));
      ++n;
    }
  }
  report.note("adaptive over even, in the mean: " + std::to_string(std::exp(sum / n)) +
              ", over 1.68 times as many: " + std::to_string(std::exp(sumDearer / n)));
}

/// Errors, steps and solution times of first and second order with the same spacing. The reference solution has
/// quadratic functions.
void compareOrders(Report &report, std::uint64_t first, int problems, double finest) {
  report.table("orders",
               "problem; phyxels; difference:4; order_difference=between orders:4; linear_percent=first order %:2; "
               "quadratic_percent=second order %:2; ratio:2; step=step ratio:2; linear_ms=first ms:0; "
               "quadratic_ms=second ms:0");
  double sum = 0.0;
  int n = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(problems); ++seed) {
    const auto one = tried(seed);
    if (!one) continue;
    const auto &[problem, survey] = *one;
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    const auto solved = [&](LatticeOrder order, double count, double *ms) {
      BodyRecipe recipe = problem.recipe;
      recipe.sampling.order = order;
      const double begin = bench::processor_ms();
      auto out = solveTrial({problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity},
                            static_cast<std::size_t>(count), samples, serialFor());
      if (ms != nullptr) *ms = bench::processor_ms() - begin;
      return out;
    };
    const auto truth = solved(LatticeOrder::quadratic, finest, nullptr);
    if (!truth) continue;
    const auto count = static_cast<double>(automaticCount(survey.volume, survey.area));
    for (const double part : {1.0 / 7.0, 0.4, 1.0, 2.5}) {
      if (part * count > 0.5 * finest) continue;
      double linear_ms = 0.0, quadratic_ms = 0.0;
      const auto linear = solved(LatticeOrder::linear, part * count, &linear_ms);
      const auto quadratic = solved(LatticeOrder::quadratic, part * count, &quadratic_ms);
      if (!linear || !quadratic) continue;
      const double ofLinear = errorOf(*linear, *truth), ofQuadratic = errorOf(*quadratic, *truth);
      report.row({problem.name, linear->phyxels, survey.difference,
                  skinDifference(*linear, *quadratic) / quadratic->largest, 100.0 * ofLinear, 100.0 * ofQuadratic,
                  ofQuadratic / ofLinear, quadratic->stableStep / linear->stableStep, linear_ms, quadratic_ms});
      sum += std::log(ofQuadratic / ofLinear);
      ++n;
    }
  }
  report.note("second over first order, in the mean: " + std::to_string(std::exp(sum / n)));
}

/// Coefficients of predictError() by least squares, for each of several weights of the difference of the orders.
/// @param rows  differences of the survey, log of the spacing over that of the fine trial, log error
void printFit(const std::vector<std::array<double, 4>> &rows) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::VectorXd y(static_cast<Eigen::Index>(rows.size()));
  for (const double weight : {0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0}) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      A.row(k) << 1.0, std::log(std::hypot(rows[i][0], weight * rows[i][1])), rows[i][2];
      y[k] = rows[i][3];
    }
    const Eigen::VectorXd x = A.colPivHouseholderQr().solve(y);
    const Eigen::VectorXd off = y - A * x;
    std::printf("kOrderDifferenceWeight %.2f, kConstant %.3f, kDifference %.3f, kOrder %.3f; spread", weight, x[0],
                x[1], x[2]);
    for (const auto &[from, to] :
         {std::pair(0.2, 9.0), std::pair(-0.2, 0.2), std::pair(-0.5, -0.2), std::pair(-9.0, -0.5)}) {
      double sum = 0.0;
      int n = 0;
      for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i][2] >= from && rows[i][2] < to) {
          sum += off[static_cast<Eigen::Index>(i)] * off[static_cast<Eigen::Index>(i)];
          ++n;
        }
      std::printf("; log spacing ratio %.1f … %.1f: %.2f (%d)", from, to, std::sqrt(sum / std::max(1, n)), n);
    }
    std::printf("\n");
  }
}

void fit(Report &report, std::uint64_t first, int problems, double finest, LatticeOrder order) {
  report.table("fit",
               "problem; phyxels; difference:5; order_difference=between orders:5; spacing_ratio_log=log spacing "
               "ratio; error:5; predicted:5");
  std::vector<std::array<double, 4>> rows;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(problems); ++seed) {
    const auto one = tried(seed, order);
    if (!one) continue;
    const auto &[problem, survey] = *one;
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    BodyRecipe second = problem.recipe;
    second.sampling.order = LatticeOrder::quadratic;
    const auto truth = solveTrial({problem.shape, second, problem.constitution, problem.foundation, problem.gravity},
                                  static_cast<std::size_t>(finest), samples, serialFor());
    if (!truth) continue;
    const auto count = static_cast<double>(automaticCount(survey.volume, survey.area));
    for (const double part : {1.0 / 7.0, 0.4, 1.0, 2.5, 6.0}) {
      if (part * count > 0.5 * finest) continue;
      const auto solved = solveTrial(problem.problem(), static_cast<std::size_t>(part * count), samples, serialFor());
      if (!solved || !(survey.difference > 0.0)) continue;
      const double error = errorOf(*solved, *truth), ratio = std::log(solved->spacing / survey.fine.spacing);
      if (!(error > 0.0)) continue;
      rows.push_back({survey.difference, survey.orderDifference, ratio, std::log(error)});
      report.row({problem.name, solved->phyxels, survey.difference, survey.orderDifference, ratio, error,
                  predictError(survey, solved->spacing).share});
    }
  }
  printFit(rows);
}

}  // namespace

void bench::checkPredictions(const Options &options, Report &report) {
  const double finest = options.number("--finest", 9000.0);
  const auto first = [&](std::uint64_t usual) { return options.count("--first", usual); };
  const auto problems = [&](const char *option) { return static_cast<int>(options.number(option, 20)); };
  if (options.has("--adaptive")) return compareAdaptive(report, first(0), problems("--adaptive"), finest);
  if (options.has("--orders")) return compareOrders(report, first(0), problems("--orders"), finest);
  const LatticeOrder order = options.has("--second-order") ? LatticeOrder::quadratic : LatticeOrder::linear;
  if (options.has("--fit")) return fit(report, first(0), problems("--fit"), finest, order);
  checkHeldOut(report, first(kHeldOut), problems("--problems"));
}
