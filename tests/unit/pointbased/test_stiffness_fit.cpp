// SPDX-License-Identifier: Apache-2.0
// Young's modulus from force-displacement curves of bodies with known moduli.
#include <cmath>
#include <random>

#include "pointbased/equilibrium_sensitivity.h"
#include "pointbased/stiffness_fit.h"
#include "sensitivity/fit_statistics.h"
#include "shapes.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::Contains;

namespace {

constexpr double kLength = 0.12, kWidth = 0.04;
const Vec3 kTip(0.12, 0.02, 0.02);

struct Experiment {
  bool isLoaded = false, isCutByFix = false;
  std::vector<double> moduli{2e4};
  MaterialLaw law = MaterialLaw::neoHookean;
  Vec3 gravity = Vec3::Zero();
  double spacing = 0.0137;
};

/// A beam held at one end. Its other end is moved downwards, or a force acts on it.
StiffnessModel modelOf(const Experiment &of) {
  const double border = of.isCutByFix ? 0.013 : 0.001;
  std::vector<Fix> fixes{{.region = BoxRegion{Vec3(-1, -1, -1), Vec3(border, 1, 1)}}};
  std::vector<Load> loads;
  const BoxRegion tip{Vec3(kLength - border, -1, -1), Vec3(1, 1, 1)};
  if (of.isLoaded)
    loads.push_back({.region = tip, .force = Vec3(0.0, -1.0, 0.0)});
  else
    fixes.push_back({.region = tip, .displacement = Vec3(0.0, -1.0, 0.0)});
  BodyRecipe recipe{.sampling = {.spacing = of.spacing}, .fixes = fixes, .loads = loads};
  if (of.moduli.size() > 1) recipe.sampling.materials = {{BoxRegion{Vec3(-1, -1, -1), Vec3(0.05, 1, 1)}, 1}};
  StiffnessModel out;
  out.rest = shapes::restState(shapes::box(Vec3::Zero(), Vec3(kLength, kWidth, kWidth), 4), recipe);
  out.constitution.materials.clear();
  for (const double modulus : of.moduli)
    out.constitution.materials.push_back({.law = of.law, .youngsModulus = modulus, .poissonRatio = 0.38});
  out.constitution.stabilisation = kLatticeStabilisation;
  out.gravity = of.gravity;
  if (of.isLoaded) out.watchedPoint = kTip;
  return out;
}

/// Solves the experiment at load steps, without the functions of the fit.
std::vector<CurvePoint> curveOf(const Experiment &of, double largest, int points) {
  std::vector<CurvePoint> out;
  const StiffnessModel model = modelOf(of);
  const ParallelFor loops = serialFor();
  double zero = 0.0;
  for (int i = of.gravity.isZero(0.0) ? 1 : 0; i <= points; ++i) {
    const double prescribed = largest * std::max(1e-9, static_cast<double>(i) / points);
    auto rest = std::make_shared<RestState>(*model.rest);
    if (of.isLoaded)
      rest->conditions.loads[0].force *= prescribed;
    else
      rest->conditions.fixes[1].displacement *= prescribed;
    Body body("truth", rest, model.constitution, loops);
    body.quasiStatic = true;
    StageClock clock(stageNames());
    NewtonSolver solver;
    const Environment environment{.gravity = of.gravity, .tolerance = 1e-12, .parallelFor = &loops, .clock = &clock};
    REQUIRE(quasiStaticStep(body, solver, environment, 0.0, 1.0).failure == "");
    std::vector<Vec3> u(1);
    interpolateDisplacements(rest->bind(std::vector{Vec3(kTip - rest->origin)}, {}), rest->positions,
                             body.state().displacements, u, loops);
    const double reaction = of.isLoaded ? 0.0 : -body.reactions(of.gravity)[1].force[1];
    const CurvePoint point = of.isLoaded ? CurvePoint{-u[0][1], prescribed} : CurvePoint{prescribed, reaction};
    if (i == 0)
      zero = of.isLoaded ? point.displacement : point.force;
    else
      out.push_back(of.isLoaded ? CurvePoint{point.displacement - zero, point.force}
                                : CurvePoint{point.displacement, point.force - zero});
  }
  return out;
}

Result<StiffnessFit> fitOf(Experiment start, const std::vector<CurvePoint> &curve, double factor,
                           const StiffnessFitSettings &settings = {}) {
  for (double &modulus : start.moduli) modulus *= factor;
  return fitStiffness(modelOf(start), curve, serialFor(), settings);
}

const std::vector<Experiment> &experiments() {
  static const std::vector<Experiment> all{{},
                                           {.isCutByFix = true},
                                           {.isLoaded = true},
                                           {.isLoaded = true, .gravity = Vec3(0.0, -3.0, 0.0)},
                                           {.gravity = Vec3(0.0, -3.0, 0.0)},
                                           {.law = MaterialLaw::corotated}};
  return all;
}

}  // namespace

// The tolerance is that of the static solutions.
TEST_CASE("the modulus of a curve without noise is found, from a start that is far away", "[fit]") {
  for (const Experiment &experiment : experiments()) {
    CAPTURE(experiment.isLoaded, experiment.isCutByFix, experiment.gravity[1], static_cast<int>(experiment.law));
    const auto curve = curveOf(experiment, experiment.isLoaded ? 0.15 : 0.02, 5);
    for (const double factor : {0.2, 30.0}) {
      CAPTURE(factor);
      const auto fit = fitOf(experiment, curve, factor);
      REQUIRE((fit ? "" : fit.error()) == "");
      CHECK(fit->hasConverged);
      CHECK(fit->verdict == StiffnessVerdict::found);
      REQUIRE(fit->moduli.size() == 1);
      CHECK(std::abs(fit->moduli[0].value / 2e4 - 1.0) < 1e-4);
      CHECK(fit->moduli[0].isOwn);
      CHECK(fit->predicted.size() == curve.size());
    }
  }
}

// Static solutions with the default tolerance of 1e-6 spacings are no equilibria at such displacements.
TEST_CASE("a curve may begin at a displacement that is far below the spacing", "[fit]") {
  std::vector<CurvePoint> curve = curveOf({}, 2e-7, 1);
  for (const CurvePoint &point : curveOf({}, 0.02, 5)) curve.push_back(point);
  const auto fit = fitOf({}, curve, 3.0);
  REQUIRE((fit ? std::string() : fit.error()) == "");
  CHECK(std::abs(fit->moduli[0].value / 2e4 - 1.0) < 1e-4);
}

TEST_CASE("derivatives of a reaction are those of central differences of static solutions", "[fit][sensitivity]") {
  for (const bool isCut : {false, true}) {
    CAPTURE(isCut);
    Experiment experiment{.isCutByFix = isCut, .moduli = {2e4, 6e4}};
    const auto solved = [&](double displacement, double first, double second) {
      experiment.moduli = {first, second};
      const StiffnessModel model = modelOf(experiment);
      auto rest = std::make_shared<RestState>(*model.rest);
      rest->conditions.fixes[1].displacement *= displacement;
      auto body = std::make_unique<Body>("beam", rest, model.constitution, serialFor());
      body->quasiStatic = true;
      StageClock clock(stageNames());
      NewtonSolver solver;
      const ParallelFor loops = serialFor();
      const Environment environment{.tolerance = 1e-13, .parallelFor = &loops, .clock = &clock};
      REQUIRE(quasiStaticStep(*body, solver, environment, 0.0, 1.0).failure == "");
      return body;
    };
    const auto reaction = [&](double displacement, double first, double second) {
      return -solved(displacement, first, second)->reactions(Vec3::Zero())[1].force[1];
    };
    const auto difference = [](double step, const auto &f) {
      return (8.0 * (f(step) - f(-step)) - (f(2.0 * step) - f(-2.0 * step))) / (12.0 * step);
    };
    const auto body = solved(0.02, 2e4, 6e4);
    StageClock clock(stageNames());
    const ParallelFor loops = serialFor();
    const Environment environment{.tolerance = 1e-13, .parallelFor = &loops, .clock = &clock};
    EquilibriumSensitivitySolver solver;
    const auto found = solver.solveReaction(*body, environment, 1.0, 1, Vec3(0.0, -1.0, 0.0), {.tolerance = 1e-11});
    REQUIRE((found ? "" : found.error()) == "");
    const auto agrees = [](double is, double should) {
      CAPTURE(is, should);
      CHECK(std::abs(is - should) <= 1e-6 * std::abs(should));
    };
    agrees(found->reaction, reaction(0.02, 2e4, 6e4));
    agrees(found->stiffness, difference(2e-4, [&](double h) { return reaction(0.02 + h, 2e4, 6e4); }));
    REQUIRE(found->youngsModuli.size() == 2);
    agrees(found->youngsModuli[0], difference(200.0, [&](double h) { return reaction(0.02, 2e4 + h, 6e4); }));
    agrees(found->youngsModuli[1], difference(600.0, [&](double h) { return reaction(0.02, 2e4, 6e4 + h); }));
  }
}

// 200 fits: their number within the interval has a standard deviation of 3.1, so 183 is four of them below 190.
TEST_CASE("the interval of confidence contains the true modulus as often as stated", "[fit]") {
  const Experiment experiment{.spacing = 0.02};
  const auto truth = curveOf(experiment, 0.02, 12);
  const double noise = 0.02 * truth.back().force;
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, noise);
  int contained = 0, found = 0;
  double largest = 0.0, widths = 0.0;
  for (int k = 0; k < 200; ++k) {
    std::vector<CurvePoint> curve = truth;
    for (CurvePoint &point : curve) point.force += normal(random);
    const auto fit = fitOf(experiment, curve, 0.7);
    REQUIRE((fit ? "" : fit.error()) == "");
    const FittedModulus &one = fit->moduli[0];
    contained += one.low <= 2e4 && 2e4 <= one.high ? 1 : 0;
    found += fit->verdict == StiffnessVerdict::found ? 1 : 0;
    largest = std::max(largest, std::abs(one.value / 2e4 - 1.0));
    widths += (one.high - one.low) / 2e4 / 200.0;
  }
  CAPTURE(contained, found, largest, widths);
  CHECK(contained >= 183);
  CHECK(contained <= 199);  // an interval that is never wrong is too wide
  CHECK(found >= 195);
  CHECK(largest < 0.04);  // 2 % of noise, twelve points
  CHECK(widths < 0.05);
}

TEST_CASE("a modulus is found within 1 % from a curve with noise and many points", "[fit]") {
  for (const bool isLoaded : {false, true}) {
    CAPTURE(isLoaded);
    const Experiment experiment{.isLoaded = isLoaded};
    std::vector<CurvePoint> curve = curveOf(experiment, isLoaded ? 0.15 : 0.02, 60);
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, 0.02 * (isLoaded ? curve.back().displacement : curve.back().force));
    for (CurvePoint &point : curve) (isLoaded ? point.displacement : point.force) += normal(random);
    const auto fit = fitOf(experiment, curve, 3.0);
    REQUIRE((fit ? "" : fit.error()) == "");
    CHECK(fit->verdict == StiffnessVerdict::found);
    CHECK(std::abs(fit->moduli[0].value / 2e4 - 1.0) < 0.01);
    CHECK(fit->moduli[0].low < 2e4);
    CHECK(fit->moduli[0].high > 2e4);
    CHECK(fit->moduli[0].high / fit->moduli[0].low < 1.03);
    CHECK(fit->solutions < 80);
  }
}

TEST_CASE("a curve that the model cannot have is unexplained", "[fit]") {
  const Experiment experiment;
  std::vector<CurvePoint> curve = curveOf(experiment, 0.02, 12);
  for (CurvePoint &point : curve) point.force *= std::pow(point.displacement / 0.02, 2.0);
  const auto fit = fitOf(experiment, curve, 1.0);
  REQUIRE((fit ? "" : fit.error()) == "");
  CHECK(fit->verdict == StiffnessVerdict::unexplained);
  CHECK_THAT(fit->reason, Contains("shape of the curve"));
  // A slight curvature is seen by the order of its residuals, and by a noise that is known.
  curve = curveOf(experiment, 0.02, 12);
  for (CurvePoint &point : curve) point.force *= 1.0 + 0.2 * (point.displacement / 0.02);
  CHECK(fitOf(experiment, curve, 1.0)->verdict == StiffnessVerdict::unexplained);
  CHECK(fitOf(experiment, curve, 1.0, {.noise = 1e-3 * curve.back().force})->verdict == StiffnessVerdict::unexplained);
  CHECK(fitOf(experiment, curve, 1.0, {.noise = 0.1 * curve.back().force})->verdict == StiffnessVerdict::found);
}

TEST_CASE("moduli of two materials are fitted one by one where the curve determines them, else together", "[fit]") {
  const Experiment experiment{.moduli = {2e4, 6e4}};
  Experiment start = experiment;
  start.moduli = {3e4, 3e4};
  const auto curve = curveOf(experiment, 0.04, 12);
  const auto exact = fitOf(start, curve, 1.0);
  REQUIRE((exact ? "" : exact.error()) == "");
  REQUIRE(exact->moduli.size() == 2);
  if (exact->moduli[0].isOwn) {
    CHECK(std::abs(exact->moduli[0].value / 2e4 - 1.0) < 0.02);
    CHECK(std::abs(exact->moduli[1].value / 6e4 - 1.0) < 0.02);
  }
  std::vector<CurvePoint> noisy = curve;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 0.03 * curve.back().force);
  for (CurvePoint &point : noisy) point.force += normal(random);
  const auto fit = fitOf(experiment, noisy, 1.5);
  REQUIRE((fit ? "" : fit.error()) == "");
  CHECK(!fit->moduli[0].isOwn);
  CHECK(!fit->moduli[1].isOwn);
  CHECK(std::abs(fit->moduli[1].value / fit->moduli[0].value - 3.0) < 1e-9);
  CHECK(std::abs(fit->moduli[0].value / 2e4 - 1.0) < 0.05);
}

TEST_CASE("curves and scenes that cannot be fitted are refused", "[fit]") {
  const Experiment experiment;
  const std::vector<CurvePoint> good{{0.005, 0.1}, {0.01, 0.2}, {0.015, 0.3}, {0.02, 0.4}};
  const auto refuses = [](const Result<StiffnessFit> &fit, const char *text) {
    REQUIRE(!fit);
    CHECK_THAT(fit.error(), Contains(text));
  };
  const auto changed = [&](std::size_t i, CurvePoint point) {
    std::vector<CurvePoint> curve = good;
    curve[i] = point;
    return fitOf(experiment, curve, 1.0);
  };
  refuses(changed(1, {std::nan(""), 0.2}), "point 2 is not finite");
  refuses(changed(1, {0.001, 0.2}), "point 2: the displacement decreases");
  refuses(changed(0, {-0.001, 0.1}), "point 1: displacement -0.001 m, must be >= 0");
  refuses(fitOf(experiment, {good.begin(), good.begin() + 3}, 1.0), "3 different displacements above 0");
  refuses(fitOf(experiment, {}, 1.0), "0 different displacements above 0");
  refuses(fitOf(experiment, {{0, 0}, {0, 0.1}, {0, 0.2}, {0, 0.3}}, 1.0), "0 different displacements above 0");
  std::vector<CurvePoint> against = good;
  for (CurvePoint &point : against) point.force = -point.force;
  refuses(fitOf(experiment, against, 1.0), "act against the displacement");
  for (CurvePoint &point : against) point.force = 0.0;
  refuses(fitOf(experiment, against, 1.0), "every force is 0");
  StiffnessModel model = modelOf(experiment);
  auto still = std::make_shared<RestState>(*model.rest);
  still->conditions.fixes[1].displacement.setZero();
  model.rest = still;
  refuses(fitStiffness(model, good, serialFor()), "0 supports move and 0 forces act");
  model = modelOf(experiment);
  model.watchedPoint = kTip;
  refuses(fitStiffness(model, good, serialFor()), "a measured point is for a force");
  model = modelOf({.isLoaded = true});
  model.watchedPoint.reset();
  refuses(fitStiffness(model, good, serialFor()), "material point");
  int calls = 0;
  refuses(fitOf(experiment, good, 1.0, {.progress = [&calls](double) { return ++calls < 3; }}), "cancelled");
}

TEST_CASE("limits of Student's distribution are those of tables", "[fit]") {
  CHECK(std::abs(detail::studentLimit(1) - 12.7062) < 1e-3);
  CHECK(std::abs(detail::studentLimit(5) - 2.57058) < 1e-4);
  CHECK(std::abs(detail::studentLimit(30) - 2.04227) < 1e-4);
  CHECK(std::abs(detail::largestChiSquared(10) / 29.588 - 1.0) < 0.01);
}
