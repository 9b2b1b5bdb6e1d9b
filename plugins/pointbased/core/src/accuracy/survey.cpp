// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pointbased/accuracy.h"
#include "pointbased/sampling.h"
#include "shape/surface_area.h"

namespace pointbased {
namespace {

constexpr std::size_t kSamples = 500;
constexpr std::pair<double, double> kParts[] = {{1.0 / 7.0, 0.4}, {0.4, 1.0}};  // of automaticCount()
constexpr double kLowest = 0.1;           // part of the height of a body that is held if it has no support
constexpr double kAstray = 100.0;         // displacement in sizes of the body beyond which it is no deformation
constexpr double kNothingInCommon = 1.0;  // difference of the trials, relative to the largest displacement
constexpr double kEarth = 9.81;           // m/s²

/// The direction in which a body is thinnest: it bends across it.
Vec3 thinDirection(const Surface &surface) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3 &x : surface.positions) mean += x;
  mean /= static_cast<double>(surface.positions.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3 &x : surface.positions) covariance += (x - mean) * (x - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvectors().col(0);
}

bool isLoaded(const AccuracyProblem &problem) {
  const BodyRecipe &recipe = problem.recipe;
  return !problem.gravity.isZero(0.0) || std::any_of(recipe.loads.begin(), recipe.loads.end(), [](const Load &load) {
    return !load.force.isZero(0.0) || load.pressure != 0.0;
  }) || std::any_of(recipe.fixes.begin(), recipe.fixes.end(), [](const Fix &fix) { return fix.prescribesMotion(); });
}

/// Lowest part of a body along `up`.
Region lowestOf(const Surface &surface, const Vec3 &up) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3 &x : surface.positions) {
    low = std::min(low, up.dot(x));
    high = std::max(high, up.dot(x));
  }
  return HalfSpaceRegion{up * (low + kLowest * (high - low)), up};
}

using Trials = std::pair<TrialSolution, TrialSolution>;

/// Two trials; two finer ones if the cells cannot resolve the supports.
Result<Trials> tryTwice(const AccuracyProblem &problem, double area, const SurfacePoints &samples,
                        const ParallelFor &parallelFor, const StopRequest *stop) {
  const auto count = static_cast<double>(automaticCount(problem.shape.volume, area));
  const auto solved = [&](double part) {
    return solveTrial(problem, static_cast<std::size_t>(part * count), samples, parallelFor, stop);
  };
  std::string failure;
  for (const auto &[coarse, fine] : kParts) {
    auto first = solved(coarse);
    if (first) {
      auto second = solved(fine);
      if (second) return Trials(std::move(*first), std::move(*second));
      failure = second.error();
    } else {
      failure = first.error();
    }
  }
  return tl::unexpected(failure);
}

/// m: skinDifference() of the coarse trial and of the same cells with quadratic functions. 0: jitter, no solution, or
/// no cell with these functions.
double orderDifference(const AccuracyProblem &problem, const TrialSolution &coarse, const SurfacePoints &samples,
                       const ParallelFor &parallelFor, const StopRequest *stop) {
  BodyRecipe recipe = problem.recipe;
  if (recipe.sampling.order != LatticeOrder::linear || recipe.sampling.jitter > 0.0) return 0.0;
  recipe.sampling = {};
  recipe.sampling.axes = problem.recipe.sampling.axes;
  recipe.sampling.materials = problem.recipe.sampling.materials;
  recipe.sampling.spacing = coarse.spacing;
  recipe.sampling.order = LatticeOrder::quadratic;
  const auto second = solveTrial({problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity},
                                 samples, parallelFor, stop);
  return second && second->quadraticPoints > 0 ? skinDifference(coarse, *second) : 0.0;
}

Vec3 worstOf(const SurfacePoints &samples, const AccuracySurvey &survey) {
  Vec3 worst = Vec3::Zero();
  double most = -1.0;
  for (std::size_t i = 0; i < survey.fine.displacements.size() && i < survey.coarse.displacements.size(); ++i)
    if (const double apart = (survey.coarse.displacements[i] - survey.fine.displacements[i]).norm(); apart > most) {
      most = apart;
      worst = samples.positions[i];
    }
  return worst;
}

}  // namespace

double AccuracySurvey::phyxelsAt(double d) const {
  const double at = fine.spacing;
  const double perArea = std::max(0.0, (static_cast<double>(fine.phyxels) * at * at * at - volume) / (area * at));
  return (volume + perArea * area * d) / (d * d * d);
}

double AccuracySurvey::spacingFor(double phyxels) const {
  double low = 1e-3 * fine.spacing, high = 1e3 * fine.spacing;
  for (int i = 0; i < 100; ++i) {
    const double mid = std::sqrt(low * high);
    (phyxelsAt(mid) > phyxels ? low : high) = mid;
  }
  return std::sqrt(low * high);
}

Result<AccuracySurvey> surveyAccuracy(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                      const StopRequest *stop) {
  AccuracySurvey survey;
  survey.order = problem.recipe.sampling.order;
  survey.volume = problem.shape.volume;
  survey.area = detail::areaOf(problem.shape.surface);
  BodyRecipe recipe = problem.recipe;
  AccuracyProblem tried{problem.shape, recipe, problem.constitution, problem.foundation, problem.gravity};
  survey.supposed = !isLoaded(problem);
  if (survey.supposed) tried.gravity = -kEarth * thinDirection(problem.shape.surface);
  if (recipe.fixes.empty() && !problem.foundation.holds()) {
    survey.supposed = true;
    if (tried.gravity.isZero(0.0)) tried.gravity = -kEarth * thinDirection(problem.shape.surface);
    Fix fix;
    fix.region = lowestOf(problem.shape.surface, -tried.gravity.normalized());
    recipe.fixes.push_back(fix);
  }
  const SurfacePoints samples = skinSamples(problem.shape.surface, recipe.fixes, kSamples);
  auto tries = tryTwice(tried, survey.area, samples, parallelFor, stop);
  if (!tries) return tl::unexpected(tries.error());
  survey.coarse = std::move(tries->first);
  survey.fine = std::move(tries->second);
  survey.largest = survey.fine.largest;
  survey.worst = worstOf(samples, survey);
  if (survey.largest > 0.0) {
    survey.difference = skinDifference(survey.coarse, survey.fine) / survey.largest;
    survey.orderDifference = orderDifference(tried, survey.coarse, samples, parallelFor, stop) / survey.largest;
  }
  if (!(survey.largest < kAstray * (problem.shape.max - problem.shape.min).norm()))
    return tl::unexpected(std::string("a part of it is held by nothing"));
  if (!(survey.difference < kNothingInCommon))
    return tl::unexpected("two coarse solutions of " + std::to_string(survey.coarse.phyxels) + " and " +
                          std::to_string(survey.fine.phyxels) +
                          " phyxels have nothing in common; it is too thin for them");
  return survey;
}

}  // namespace pointbased
