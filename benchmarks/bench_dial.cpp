// SPDX-License-Identifier: Apache-2.0
// Checks the predictions of the accuracy setting.
//
//   bench_dial [--first SEED] [--problems N] [--csv FILE] [--json FILE]
//   bench_dial --fit PROBLEMS [--first SEED] [--finest PHYXELS]
//   bench_dial --adaptive PROBLEMS [--first SEED] [--finest PHYXELS]
//
// Bodies, materials and loads that the model was not fitted to, drawn by seed (dial/random_problems.h), each with an
// accuracy target of 3, 5, 10 or 20 % of its largest displacement. For each: two trials, the chosen sampling, and then
//   error   the body solved with its own law at that sampling, against eight times as many phyxels; the remaining
//           error of that reference is added by the order of the model
//   cost    the time per frame of the body in half a second of explicit steps under its loads, against the
//           time measured when it was built
// --fit: errors of linear solutions of seven samplings of each body against a fine one, and the coefficients of the
// model by least squares. Those in choose_sampling.cpp are from seeds 0 … 29. --adaptive: errors of linear solutions
// with cells of uniform size, of the same number of cells some of which are halved (adaptSampling()), and of 1.68 times
// as many cells of uniform size.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "bench/report.h"
#include "bench/timing.h"
#include "dial/random_problems.h"
#include "pointbased/adaptive_sampling.h"
#include "pointbased/sampling.h"
#include "pointbased/simulator.h"

namespace {

using namespace pointbased;

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

std::unique_ptr<Simulator> worldOf(const dial::RandomProblem &problem, double spacing, Integrator integrator,
                                   std::size_t &id) {
  BodyRecipe recipe = problem.recipe;
  recipe.sampling.spacing = spacing;
  const auto rest = buildRestState(problem.shape, recipe, {}, serialFor());
  if (!rest) {
    std::printf("%s: %s\n", problem.name.c_str(), rest.error().c_str());
    return nullptr;
  }
  auto simulator = std::make_unique<Simulator>();
  WorldSettings world;
  world.gravity = problem.gravity;
  world.integrator = integrator;
  world.loadSteps = 3;
  simulator->setWorld(world);
  auto body = std::make_unique<Body>(problem.name, *rest, problem.constitution, serialFor());
  (void)body->setFoundation(problem.foundation);
  id = simulator->addBody(std::move(body));
  return simulator;
}

/// The body at rest under its loads with its own law; nullopt where there is no equilibrium.
std::optional<TrialSolution> solve(const dial::RandomProblem &problem, double spacing, const SurfacePoints &samples) {
  std::size_t id = 0;
  const auto simulator = worldOf(problem, spacing, Integrator::quasiStatic, id);
  if (!simulator) return std::nullopt;
  while (!simulator->finished())
    if (!simulator->step()) return std::nullopt;
  const Body &body = *simulator->body(id);
  if (body.stopped) return std::nullopt;
  const RestState &rest = body.rest();
  TrialSolution out;
  out.spacing = rest.spacing;
  out.phyxels = rest.phyxelCount();
  out.ways = displacementsAt(rest, body.state().displacements, samples, serialFor());
  for (const Vec3 &u : out.ways) out.largest = std::max(out.largest, u.norm());
  return out;
}

struct FrameTimes {
  double promised = 0.0, measured = 0.0;  // ms
};

/// The time per frame predicted when the body is built, and the mean wall time per frame over half a simulated second.
FrameTimes frameTimes(const dial::RandomProblem &problem, double spacing) {
  constexpr double kSimulated = 0.5;  // s
  std::size_t id = 0;
  const auto simulator = worldOf(problem, spacing, Integrator::explicitVerlet, id);
  if (!simulator) return {};
  FrameTimes out;
  out.promised = measureFrame(*simulator->body(id), simulator->world().settings(), {}, serialFor(), nullptr);
  while (simulator->time() < kSimulated)
    if (!simulator->step()) return {};
  out.measured = 1e3 * kFrame * simulator->diagnostics().costOf(id);
  return out;
}

struct Tried {
  dial::RandomProblem problem;
  AccuracySurvey survey;
};

std::optional<Tried> tried(std::uint64_t seed) {
  Tried out{dial::randomProblem(seed), {}};
  auto survey = surveyAccuracy(out.problem.problem(), serialFor());
  if (!survey) {
    std::printf("%s: not predicted: %s\n", out.problem.name.c_str(), survey.error().c_str());
    return std::nullopt;
  }
  out.survey = std::move(*survey);
  return out;
}

int heldOut(const bench::CommandLine &line, std::uint64_t first, int problems) {
  bench::Report report(line.name(), line.options());
  report.table("promises", {{"problem", "problem                             "},
                            {"wish_percent", "wish %", 0},
                            {"phyxels", "phyxels"},
                            {"promised_percent", "promised %", 2},
                            {"low_percent", "from", 2},
                            {"high_percent", "to", 2},
                            {"true_percent", "true %", 2},
                            {"in_band", "in"},
                            {"promised_ms", "promised ms", 3},
                            {"measured_ms", "measured ms", 3},
                            {"ratio", "ratio", 2},
                            {"survey_ms", "survey ms", 0}});
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
    const SamplingChoice choice =
        chooseSampling(survey, problem.constitution, setting, {AccuracyTarget::Kind::share, wish});
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    const auto solved = solve(problem, choice.spacing, samples);
    const double fine = std::clamp(8.0 * static_cast<double>(choice.count), 3000.0, 16000.0);
    const auto truth = solved ? solve(problem, survey.spacingFor(fine), samples) : std::nullopt;
    if (!solved || !truth) {
      report.note(problem.name + ": no equilibrium was found; left out");
      continue;
    }
    const double lacking = 1.0 - std::pow(truth->spacing / solved->spacing, kOrder);
    const double error = skinDifference(*solved, *truth) / truth->largest / lacking;
    const ErrorPrediction promised = predictError(survey, solved->spacing);
    const bool isIn = error >= promised.low && error <= promised.high;
    const FrameTimes frame = frameTimes(problem, solved->spacing);
    const double ratio = frame.measured / frame.promised;
    ++all;
    inBand += isIn ? 1 : 0;
    inTime += std::abs(ratio - 1.0) <= 0.25 ? 1 : 0;
    met += error <= wish ? 1 : 0;
    report.row({problem.name, 100.0 * wish, solved->phyxels, 100.0 * promised.share, 100.0 * promised.low,
                100.0 * promised.high, 100.0 * error, isIn ? "yes" : "NO", frame.promised, frame.measured, ratio,
                survey_ms});
  }
  report.note("errors within their band: " + std::to_string(inBand) + " of " + std::to_string(all) +
              ", wishes met: " + std::to_string(met) + ", costs within 25 %: " + std::to_string(inTime));
  report.fact("in_band", inBand);
  report.fact("costs_within_25_percent", inTime);
  report.fact("problems", all);
  return report.write();
}

/// Errors of bodies with cells of uniform size, and with finer cells where a trial locates the error.
int adaptive(const bench::CommandLine &line, std::uint64_t first, int problems, double finest) {
  bench::Report report(line.name(), line.options());
  report.table("adaptive", {{"problem", "problem                             "},
                            {"wanted", "wanted"},
                            {"even", "even"},
                            {"even_percent", "error %", 3},
                            {"dearer", "1.68 x"},
                            {"dearer_percent", "error %", 3},
                            {"adaptive", "adaptive"},
                            {"adaptive_percent", "error %", 3},
                            {"share", "share", 2},
                            {"halved", "halved"},
                            {"step", "step", 2},
                            {"ratio", "adaptive/even", 2},
                            {"ratio_dearer", "adaptive/dearer", 2}});
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
  return report.write();
}

int fit(std::uint64_t first, int problems, double finest) {
  std::vector<std::array<double, 3>> rows;  // log difference, log spacing over that of the fine trial, log error
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(problems); ++seed) {
    const auto one = tried(seed);
    if (!one) continue;
    const auto &[problem, survey] = *one;
    const SurfacePoints samples = skinSamples(problem.shape.surface, problem.recipe.fixes, 500);
    const auto truth = solveTrial(problem.problem(), static_cast<std::size_t>(finest), samples, serialFor());
    if (!truth) continue;
    const auto count = static_cast<double>(automaticCount(survey.volume, survey.area));
    for (const double part : {1.0 / 7.0, 0.4, 1.0, 2.5, 6.0}) {
      if (part * count > 0.5 * finest) continue;
      const auto solved = solveTrial(problem.problem(), static_cast<std::size_t>(part * count), samples, serialFor());
      if (!solved || !(survey.difference > 0.0)) continue;
      const double lacking = 1.0 - std::pow(truth->spacing / solved->spacing, kOrder);
      const double error = skinDifference(*solved, *truth) / truth->largest / lacking;
      if (!(error > 0.0)) continue;
      rows.push_back({std::log(survey.difference), std::log(solved->spacing / survey.fine.spacing), std::log(error)});
      std::printf("%s; %zu phyxels; difference %.5f; way %.3f; error %.5f; predicted %.5f\n", problem.name.c_str(),
                  solved->phyxels, survey.difference, rows.back()[1], error,
                  predictError(survey, solved->spacing).share);
      std::fflush(stdout);
    }
  }
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::VectorXd y(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    A.row(k) << 1.0, rows[i][0], rows[i][1];
    y[k] = rows[i][2];
  }
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(y);
  const Eigen::VectorXd off = y - A * x;
  std::printf("kConstant %.3f, kDifference %.3f, kOrder %.3f; spread", x[0], x[1], x[2]);
  for (const auto &[from, to] :
       {std::pair(0.2, 9.0), std::pair(-0.2, 0.2), std::pair(-0.5, -0.2), std::pair(-9.0, -0.5)}) {
    double sum = 0.0;
    int n = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i][1] >= from && rows[i][1] < to) {
        sum += off[static_cast<Eigen::Index>(i)] * off[static_cast<Eigen::Index>(i)];
        ++n;
      }
    std::printf("; way %.1f … %.1f: %.2f (%d)", from, to, std::sqrt(sum / std::max(1, n)), n);
  }
  std::printf("\n");
  return 0;
}

}  // namespace

int main(int argc, char **argv) {
  std::optional<std::uint64_t> first;
  std::optional<int> problems;
  double finest = 9000.0;
  bool isFit = false;
  bench::CommandLine line("bench_dial");
  line.add("--first", "SEED", [&](const std::string &text) { first = std::strtoull(text.c_str(), nullptr, 10); });
  line.add("--problems", "N", [&](const std::string &text) { problems = std::atoi(text.c_str()); });
  line.add("--finest", "PHYXELS", [&](const std::string &text) { finest = std::atof(text.c_str()); });
  line.add("--fit", "PROBLEMS", [&](const std::string &text) {
    isFit = true;
    problems = std::atoi(text.c_str());
  });
  bool isAdaptive = false;
  line.add("--adaptive", "PROBLEMS", [&](const std::string &text) {
    isAdaptive = true;
    problems = std::atoi(text.c_str());
  });
  if (const auto exit = line.parse(argc, argv)) return *exit;
  if (isAdaptive) return adaptive(line, first.value_or(0), problems.value_or(30), finest);
  if (isFit) return fit(first.value_or(0), problems.value_or(30), finest);
  return heldOut(line, first.value_or(kHeldOut), problems.value_or(20));
}
