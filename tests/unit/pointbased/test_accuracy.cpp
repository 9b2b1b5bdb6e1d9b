// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lattice_cases.h"
#include "pointbased/accuracy.h"
#include "pointbased/engine.h"
#include "pointbased/sampling.h"
#include "support/catch.h"
#include "surfaces.h"

using namespace pointbased;
using Catch::Matchers::Contains;

namespace {

constexpr double kLength = 0.2, kSide = 0.04;  // m, of the beam
constexpr double kArea = 4 * kLength * kSide + 2 * kSide * kSide;

BodyShape beam() { return shapes::box(Vec3::Zero(), Vec3(kLength, kSide, kSide), 6); }

/// A beam that is clamped at x = 0 and pulled down at its other end.
struct Cantilever {
  BodyShape shape = beam();
  BodyRecipe recipe{
      .fixes = {{.region = HalfSpaceRegion{Vec3::Zero(), Vec3::UnitX()}}},
      .loads = {{.region = HalfSpaceRegion{Vec3(kLength, 0, 0), -Vec3::UnitX()}, .force = Vec3(0, 0, -1.6e-3)}}};
  Constitution constitution{{{.youngsModulus = 1e4, .poissonRatio = 0.3}}, kLatticeStabilisation};
  [[nodiscard]] AccuracyProblem problem() const { return {shape, recipe, constitution}; }
  [[nodiscard]] AccuracySurvey survey() const {
    auto survey = surveyAccuracy(problem(), serialFor());
    REQUIRE(survey.has_value());
    return *survey;
  }
};

CostSetting explicitSetting() {
  CostSetting setting;
  setting.speed = nominalSpeed();
  setting.world.integrator = Integrator::explicitVerlet;
  return setting;
}

}  // namespace

TEST_CASE("a trial is what the linear law says at the loads that are there") {
  Cantilever cantilever;
  const SurfacePoints samples = skinSamples(cantilever.shape.surface, cantilever.recipe.fixes, 1000);
  const auto once = solveTrial(cantilever.problem(), 400, samples, serialFor());
  REQUIRE(once.has_value());
  // P L³/3EI + P L/(k G A) = 2.03 mm.
  CHECK(once->largest == Approx(2.03e-3).epsilon(0.12));
  cantilever.recipe.loads.front().force *= 3.0;
  const auto thrice = solveTrial(cantilever.problem(), 400, samples, serialFor());
  REQUIRE(thrice.has_value());
  for (std::size_t i = 0; i < samples.count(); ++i)
    CHECK((thrice->displacements[i] - 3.0 * once->displacements[i]).norm() <= 1e-4 * once->largest);
}

TEST_CASE("samples of the skin lie evenly, and leave out what is prescribed") {
  const Cantilever cantilever;
  const SurfacePoints all = skinSamples(cantilever.shape.surface, {}, 500);
  const SurfacePoints open = skinSamples(cantilever.shape.surface, cantilever.recipe.fixes, 500);
  CHECK(static_cast<double>(all.count()) == Approx(500.0).epsilon(0.1));
  CHECK(open.count() < all.count());
  CHECK(std::all_of(open.positions.begin(), open.positions.end(), [](const Vec3 &x) { return x[0] > 0.0; }));
  // A face gets its share of the area, whether its triangles are large or small.
  const auto onTop = [](const SurfacePoints &points) {
    return static_cast<double>(
        std::count_if(points.normals.begin(), points.normals.end(), [](const Vec3 &n) { return n[2] > 0.9; }));
  };
  const double share = kLength * kSide / kArea;
  CHECK(onTop(all) == Approx(500.0 * share).epsilon(0.15));
  const SurfacePoints large = skinSamples(shapes::boxSurface(Vec3::Zero(), Vec3(kLength, kSide, kSide)), {}, 500);
  CHECK(onTop(large) == Approx(500.0 * share).epsilon(0.15));
}

TEST_CASE("the error of a ball that hangs from a cap is within the band that is predicted") {
  constexpr double kRadius = 0.05;
  BodyShape ball = lattice_cases::ball(Vec3::Zero(), kRadius);
  ball.surface = shapes::ballSurface(Vec3::Zero(), kRadius, 40);
  const Vec3 direction = Vec3(0.4, 0.2, 1.0).normalized();
  const BodyRecipe recipe{.fixes = {{.region = HalfSpaceRegion{0.6 * kRadius * direction, -direction}}}};
  const Constitution constitution{{Material{}}, kLatticeStabilisation};
  const AccuracyProblem problem{ball, recipe, constitution, {}, Vec3(3.0, 0.0, -9.0)};
  const auto survey = surveyAccuracy(problem, serialFor());
  REQUIRE(survey.has_value());
  const SurfacePoints samples = skinSamples(ball.surface, recipe.fixes, 500);
  const auto truth = solveTrial(problem, 6000, samples, serialFor());
  REQUIRE(truth.has_value());
  for (const std::size_t count : {300, 1000}) {
    const auto solved = solveTrial(problem, count, samples, serialFor());
    REQUIRE(solved.has_value());
    const double error = skinDifference(*solved, *truth) / truth->largest;
    const ErrorPrediction predicted = predictError(*survey, solved->spacing);
    INFO(error << " " << predicted.low << " " << predicted.share << " " << predicted.high);
    CHECK(error >= predicted.low);
    CHECK(error <= predicted.high);
  }
}

TEST_CASE("finer samplings are predicted to be more accurate and dearer") {
  const AccuracySurvey survey = Cantilever().survey();
  double error = 1e9, cost = 0.0;
  for (const double count : {60.0, 200.0, 1000.0, 5000.0, 50000.0}) {
    const double spacing = survey.spacingFor(count);
    CHECK(survey.phyxelsAt(spacing) == Approx(count).epsilon(1e-6));
    const ErrorPrediction predicted = predictError(survey, spacing);
    const double frame_ms = predictCost(survey, Constitution{}, explicitSetting(), spacing);
    CHECK(predicted.low < predicted.share);
    CHECK(predicted.share < predicted.likely);
    CHECK(predicted.likely < predicted.high);
    CHECK(predicted.share < error);
    CHECK(frame_ms > cost);
    error = predicted.share;
    cost = frame_ms;
  }
}

TEST_CASE("the cheapest sampling that does what is wished is chosen") {
  const Cantilever cantilever;
  const AccuracySurvey survey = cantilever.survey();
  const CostSetting setting = explicitSetting();
  const auto chosen = [&](AccuracyTarget::Kind kind, double value) {
    return chooseSampling(survey, cantilever.constitution, setting, {kind, value});
  };
  // No sampling is coarser than the coarse trial.
  const double most = predictError(survey, survey.coarse.spacing).likely;
  CHECK(chosen(AccuracyTarget::Kind::share, 2.0 * most).spacing == Approx(survey.coarse.spacing));
  for (const double share : {0.5 * most, 0.2 * most}) {
    const SamplingChoice choice = chosen(AccuracyTarget::Kind::share, share);
    CHECK(choice.unmet.empty());
    CHECK(choice.error.likely <= share * 1.001);
    CHECK(predictError(survey, 1.05 * choice.spacing).likely > share);
    const SamplingChoice inMetres = chosen(AccuracyTarget::Kind::length, share * survey.largest);
    CHECK(inMetres.spacing == Approx(choice.spacing));
  }
  const SamplingChoice cheap = chosen(AccuracyTarget::Kind::budget, 2e-3);
  CHECK(cheap.unmet.empty());
  CHECK(cheap.frame_ms <= 2.0 * kBudgetToUse * 1.001);
  CHECK(predictCost(survey, cantilever.constitution, setting, 0.95 * cheap.spacing) > 2.0 * kBudgetToUse);
}

TEST_CASE("a budget is kept by bodies that touch others, which are coarser for it") {
  const Cantilever cantilever;
  const AccuracySurvey survey = cantilever.survey();
  CostSetting alone = explicitSetting();
  alone.surfels = 50000;
  CostSetting touching = alone;
  touching.touches = true;
  const auto chosen = [&](const CostSetting &setting, AccuracyTarget::Kind kind, double value) {
    return chooseSampling(survey, cantilever.constitution, setting, {kind, value});
  };
  const SamplingChoice free = chosen(alone, AccuracyTarget::Kind::budget, 0.2),
                       among = chosen(touching, AccuracyTarget::Kind::budget, 0.2);
  CHECK(free.touching_ms == 0.0);
  CHECK(among.touching_ms > 0.0);
  CHECK(among.count < free.count);
  CHECK(among.unmet.empty());
  CHECK(among.frame_ms + among.touching_ms <= 200.0 * kBudgetToUse * 1.001);
  // 50 000 vertices, a fifth of which touch, in each substep.
  const double substeps = kFrame * survey.fine.spacing / (kStepSafety * survey.fine.stableStep * among.spacing);
  CHECK(among.touching_ms == Approx(1e-6 * kTouched * 50000.0 * touching.speed.touch_ns * substeps).epsilon(1e-6));
  // An accuracy target and the default do not depend on it; a quasi-static solution has no frames.
  CHECK(chosen(touching, AccuracyTarget::Kind::share, 0.05).spacing ==
        chosen(alone, AccuracyTarget::Kind::share, 0.05).spacing);
  CHECK(chosen(touching, AccuracyTarget::Kind::standard, 1.0).spacing ==
        chosen(alone, AccuracyTarget::Kind::standard, 1.0).spacing);
  touching.world.integrator = Integrator::quasiStatic;
  CHECK(predictTouching(survey, cantilever.constitution, touching, among.spacing) == 0.0);
}

TEST_CASE("a wish that cannot be met is told with what can be had") {
  const Cantilever cantilever;
  const AccuracySurvey survey = cantilever.survey();
  const auto chosen = [&](AccuracyTarget::Kind kind, double value) {
    return chooseSampling(survey, cantilever.constitution, explicitSetting(), {kind, value});
  };
  const SamplingChoice exact = chosen(AccuracyTarget::Kind::share, 1e-9);
  CHECK_THAT(exact.unmet, Contains("not sure to be had") && Contains("100000 phyxels") && Contains("expected are"));
  CHECK(exact.count > 90000);
  const SamplingChoice instant = chosen(AccuracyTarget::Kind::budget, 1e-9);
  CHECK_THAT(instant.unmet, Contains("ms a frame cannot be had") && Contains("phyxels"));
}

TEST_CASE("without a wish a body is never coarser than before, and finer where it would be off") {
  const Cantilever cantilever;
  AccuracySurvey survey = cantilever.survey();
  const auto least = static_cast<double>(automaticCount(survey.volume, survey.area));
  const auto standard = [&] {
    return chooseSampling(survey, cantilever.constitution, explicitSetting(), {AccuracyTarget::Kind::standard, 1.0});
  };
  survey.difference = 1e-4;
  CHECK(static_cast<double>(standard().count) == Approx(least).margin(1.0));
  survey.difference = 0.15;
  const SamplingChoice finer = standard();
  CHECK(static_cast<double>(finer.count) > 1.5 * least);
  CHECK(finer.error.share <= kStandardError * 1.001);
  // The sampling does not exceed the budget of a frame, and reports so.
  survey.difference = 50.0;
  const SamplingChoice limited = standard();
  CHECK(limited.frame_ms <= 1e3 * kStandardBudget);
  CHECK_THAT(limited.unmet, Contains("within 16 ms a frame"));
}

TEST_CASE("bodies that nothing holds or loads are tried as if something did") {
  Cantilever cantilever;
  cantilever.recipe.loads.clear();
  CHECK(cantilever.survey().supposed);
  cantilever.recipe.fixes.clear();
  const AccuracySurvey free = cantilever.survey();
  CHECK(free.supposed);
  CHECK(free.largest > 0.0);
  CHECK(free.difference > 0.0);
  // An elastic foundation counts as a support.
  AccuracyProblem bedded = cantilever.problem();
  bedded.foundation.stiffness = bedded.foundation.tangential = 1e4;
  bedded.gravity = Vec3(0, 0, -9.81);
  const auto survey = surveyAccuracy(bedded, serialFor());
  REQUIRE(survey.has_value());
  CHECK_FALSE(survey->supposed);
}

TEST_CASE("of a body that is held at a point nothing is predicted") {
  Cantilever cantilever;
  cantilever.recipe.fixes.front().region = BoxRegion{Vec3(-1e-3, -1e-3, -1e-3), Vec3::Constant(2e-4)};
  const auto survey = surveyAccuracy(cantilever.problem(), serialFor());
  REQUIRE_FALSE(survey.has_value());
  CHECK_FALSE(survey.error().empty());
}

TEST_CASE("a survey is the same for any division of the loops, and ends when it is no longer wanted") {
  const Cantilever cantilever;
  const ParallelFor divided = [](std::size_t n, std::size_t grain,
                                 const std::function<void(std::size_t, std::size_t)> &body) {
    for (std::size_t from = 0; from < n; from += std::max<std::size_t>(1, grain))
      body(from, std::min(n, from + std::max<std::size_t>(1, grain)));
  };
  const auto a = surveyAccuracy(cantilever.problem(), serialFor());
  const auto b = surveyAccuracy(cantilever.problem(), divided);
  REQUIRE((a && b));
  CHECK(a->difference == b->difference);
  CHECK(a->fine.stableStep == b->fine.stableStep);
  struct Raised final : StopRequest {
    [[nodiscard]] bool isRaised() const noexcept override { return true; }
  } raised;
  CHECK_THROWS_AS(surveyAccuracy(cantilever.problem(), serialFor(), &raised), Stopped);
}

TEST_CASE("the speed of a machine is kept as text, and what is none is refused") {
  MachineSpeed speed = nominalSpeed();
  speed.threads = 3;
  speed.kernels = "AVX2";
  const auto again = speedFrom(textOf(speed));
  REQUIRE(again.has_value());
  CHECK(again->double_ns == speed.double_ns);
  CHECK(again->single_ns == speed.single_ns);
  CHECK(again->contact_ns == speed.contact_ns);
  CHECK(again->touch_ns == speed.touch_ns);
  CHECK(again->surfel_ns == speed.surfel_ns);
  CHECK(again->threads == 3);
  CHECK(again->kernels == "AVX2");
  CHECK(speedFrom("2 1 AVX2 1 2 3 4 1 2 3 4 5 6 7").has_value());
  for (const char *text : {"", "2", "1 1 AVX2 1 2 3 4 1 2 3 4 5 6 7", "2 1 AVX2 1 2 3 4 1 2 3 4 5 6",
                           "2 1 AVX2 1 2 3 -4 1 2 3 4 5 6 7", "2 1 AVX2 1 2 3 nan 1 2 3 4 5 6 7", "x y z"})
    CHECK_FALSE(speedFrom(text).has_value());
  // Interpolated between the measured sizes, and equal to the nearest one beyond them.
  speed.double_ns = {100.0, 50.0, 60.0, 80.0};
  CHECK(speed.perPoint(1.0, Precision::doublePrecision) == 100.0);
  CHECK(speed.perPoint(1000.0, Precision::doublePrecision) == Approx(75.0));
  CHECK(speed.perPoint(1e7, Precision::doublePrecision) == 80.0);
}

TEST_CASE("a machine is known again by its time, and another one is not") {
  const MachineSpeed here = measureSpeed(serialFor(), 1);
  CHECK(here.double_ns[1] > 0.0);
  CHECK(here.surfel_ns > 0.0);
  CHECK(here.touch_ns > 0.0);
  MachineSpeed other = here;
  other.threads = 2;
  CHECK_FALSE(matchesThisMachine(other, serialFor(), 1));
  other = here;
  for (double &ns : other.double_ns) ns *= 100.0;
  CHECK_FALSE(matchesThisMachine(other, serialFor(), 1));
}

namespace {

/// In a lattice that is turned against the beam.
Cantilever obliqueCantilever() {
  Cantilever cantilever;
  cantilever.recipe.sampling.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  return cantilever;
}

double relativeError(const AccuracySurvey &survey, const TrialSolution &truth) {
  return skinDifference(survey.fine, truth) / truth.largest;
}

}  // namespace

TEST_CASE("the error of cells oblique to a body is part of the prediction") {
  CHECK(Cantilever().survey().orderDifference < 0.005);  // its lattice is along the faces
  const Cantilever oblique = obliqueCantilever();
  const AccuracySurvey survey = oblique.survey();
  CHECK(survey.order == LatticeOrder::linear);
  CHECK(survey.orderDifference > 0.01);
  AccuracySurvey without = survey;
  without.orderDifference = 0.0;
  CHECK(predictError(survey, survey.fine.spacing).share > predictError(without, survey.fine.spacing).share);

  BodyRecipe recipe = oblique.recipe;
  recipe.sampling.order = LatticeOrder::quadratic;
  const SurfacePoints samples = skinSamples(oblique.shape.surface, oblique.recipe.fixes, 500);
  const auto truth = solveTrial({oblique.shape, recipe, oblique.constitution}, 8000, samples, serialFor());
  REQUIRE(truth.has_value());
  const ErrorPrediction predicted = predictError(survey, survey.fine.spacing);
  INFO(predicted.low << " … " << predicted.high);
  CHECK(relativeError(survey, *truth) >= predicted.low);
  CHECK(relativeError(survey, *truth) <= predicted.high);
}

TEST_CASE("second order is chosen where it costs less for the same error") {
  const Cantilever oblique = obliqueCantilever();
  const AccuracySurvey first = oblique.survey();
  Cantilever turned = oblique;
  turned.recipe.sampling.order = LatticeOrder::quadratic;
  const AccuracySurvey second = turned.survey();
  CHECK(second.order == LatticeOrder::quadratic);
  CHECK(second.fine.quadraticPoints > 0);
  CHECK(second.orderDifference == 0.0);
  CHECK(second.difference < first.difference);
  const auto chosen = [&](const AccuracySurvey &survey, const AccuracyTarget &target) {
    return chooseSampling(survey, oblique.constitution, explicitSetting(), target);
  };
  const AccuracyTarget error{AccuracyTarget::Kind::share, 0.02}, budget{AccuracyTarget::Kind::budget, 3e-3},
      loose{AccuracyTarget::Kind::share, 0.5};
  for (const AccuracyTarget &target : {error, budget}) {
    CHECK(mayNeedSecondOrder(first, chosen(first, target), oblique.constitution, target));
    CHECK(prefersSecondOrder(chosen(first, target), chosen(second, target), target));
    CHECK_FALSE(prefersSecondOrder(chosen(second, target), chosen(first, target), target));
  }
  CHECK_FALSE(mayNeedSecondOrder(first, chosen(first, loose), oblique.constitution, loose));
  // Kernels of quadratic functions do not support plastic flow.
  Constitution flowing = oblique.constitution;
  flowing.materials.front().plastic.yield = 0.1;
  flowing.materials.front().plastic.creep = 0.5;
  CHECK_FALSE(mayNeedSecondOrder(first, chosen(first, error), flowing, error));

  // Only one of the two meets the target.
  SamplingChoice met, unmet;
  unmet.unmet = "too large";
  CHECK(prefersSecondOrder(unmet, met, error));
  CHECK_FALSE(prefersSecondOrder(met, unmet, error));
  // A smaller error is no reason to exceed the time.
  const AccuracyTarget standard{AccuracyTarget::Kind::standard, 1.0};
  SamplingChoice inTime = unmet, late = unmet;
  inTime.error.share = 0.07;
  late.error.share = 0.03;
  late.isInTime = false;
  CHECK_FALSE(prefersSecondOrder(inTime, late, standard));
  CHECK(prefersSecondOrder(late, inTime, standard));
}

TEST_CASE("second order is suggested only for elongated or flat bodies oblique to their lattice") {
  const Constitution elastic{{{.youngsModulus = 1e4, .poissonRatio = 0.3}}, kLatticeStabilisation};
  const auto bar = [](double length, double width, double thickness) {
    return shapes::box(Vec3(0.3, -0.2, 0.1), Vec3(0.3 + length, -0.2 + width, 0.1 + thickness), 1);
  };
  const Mat3 oblique = Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const auto isSuggested = [&](const BodyShape &shape, const LatticeSampling &sampling) {
    return suggestsSecondOrder(shape, {.sampling = sampling}, elastic);
  };
  BodyShape beam = bar(0.041, 0.01, 0.01);
  CHECK(isSuggested(beam, {.spacing = 0.002, .axes = oblique}));
  CHECK(isSuggested(beam, {.count = 500, .axes = oblique}));
  CHECK(isSuggested(bar(0.041, 0.041, 0.01), {.count = 500, .axes = oblique}));  // a plate
  CHECK_FALSE(isSuggested(bar(0.039, 0.01, 0.01), {.count = 500, .axes = oblique}));
  CHECK_FALSE(isSuggested(bar(0.01, 0.01, 0.01), {.count = 500, .axes = oblique}));
  // By default the lattice follows the faces, also if the beam is rotated.
  CHECK_FALSE(isSuggested(beam, {.count = 500}));
  for (Vec3 &x : beam.surface.positions) x = oblique * x;
  CHECK_FALSE(isSuggested(beam, {.count = 500}));
  CHECK(isSuggested(beam, {.count = 500, .axes = Mat3::Identity()}));
  const Mat3 slightly = Eigen::AngleAxisd(0.1, Vec3::UnitX()).toRotationMatrix();
  CHECK_FALSE(isSuggested(beam, {.count = 500, .axes = Mat3(oblique * slightly)}));

  // Two compact parts far apart are not elongated.
  BodyShape pair = bar(0.01, 0.01, 0.01);
  const Surface far = shapes::boxSurface(Vec3(0.5, 0, 0), Vec3(0.51, 0.01, 0.01));
  const auto first = static_cast<Index>(pair.surface.positions.size());
  pair.surface.positions.insert(pair.surface.positions.end(), far.positions.begin(), far.positions.end());
  for (const auto &t : far.triangles) pair.surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  CHECK_FALSE(isSuggested(pair, {.count = 500, .axes = oblique}));

  // Neither irregular cells nor materials without vectorised kernels.
  const LatticeSampling plain{.spacing = 0.002, .axes = Mat3::Identity()};
  LatticeSampling irregular = plain;
  irregular.jitter = 0.1;
  CHECK_FALSE(isSuggested(beam, irregular));
  irregular = plain;
  irregular.surfaceSpacing = 0.001;
  CHECK_FALSE(isSuggested(beam, irregular));
  Constitution other = elastic;
  other.materials.front().plastic.yield = 0.1;
  other.materials.front().plastic.creep = 0.5;
  CHECK_FALSE(suggestsSecondOrder(beam, {.sampling = plain}, other));
  other = elastic;
  other.materials.push_back(other.materials.front());
  CHECK_FALSE(suggestsSecondOrder(beam, {.sampling = plain}, other));
  // Auxetic: no kernel evaluates the logarithm's negative factor.
  other = elastic;
  other.materials.front().law = MaterialLaw::neoHookean;
  CHECK(suggestsSecondOrder(beam, {.sampling = plain}, other));
  other.materials.front().poissonRatio = -0.2;
  CHECK_FALSE(suggestsSecondOrder(beam, {.sampling = plain}, other));
}
