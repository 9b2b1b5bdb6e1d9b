// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "pointbased/accuracy.h"
#include "pointbased/sampling.h"
#include "stepping/step_cost.h"

namespace pointbased {
namespace {

// Fitted to random bodies, bench_dial --fit:
// log error = kConstant + kDifference log(difference) + kOrder log(spacing / spacing of the fine trial)
constexpr double kConstant = -0.25, kDifference = 1.12, kOrder = 1.75;
constexpr double kSpread = 0.45;       // standard deviation of log error near the fine trial
constexpr double kSpreadPerWay = 0.3;  // more of it per log of the way to finer spacings
constexpr double kNineOfTen = 1.645;   // standard deviations on both sides
constexpr double kLeastDifference = 1e-5;
constexpr double kFewest = 50.0;                     // phyxels that are proposed
constexpr double kEvaluationsPerIncrement = 2000.0;  // of a quasi-static increment of 500 phyxels

/// How much longer a substep takes where the material remembers, or is not one of the kernels' (bench_scaling,
/// bench_law).
double materialFactor(const Constitution &constitution) {
  double factor = 1.0;
  for (const Material &m : constitution.materials) {
    double own = 1.0;
    if (m.plastic.enabled()) own = 1.6;
    if (m.relaxes()) own = 2.0;
    if (m.law == MaterialLaw::custom) own = 13.0;
    factor = std::max(factor, own);
  }
  return factor;
}

std::string percent(double share) { return detail::number(100.0 * share, 2) + " %"; }

}  // namespace

ErrorPrediction predictError(const AccuracySurvey &survey, double spacing) {
  const double way = std::log(spacing / survey.fine.spacing);
  const double log = kConstant + kDifference * std::log(std::max(survey.difference, kLeastDifference)) + kOrder * way;
  const double spread = kSpread + kSpreadPerWay * std::max(0.0, -way);
  ErrorPrediction out;
  out.share = std::exp(log);
  out.low = std::exp(log - kNineOfTen * spread);
  out.high = std::exp(log + kNineOfTen * spread);
  out.likely = std::exp(log + spread);
  return out;
}

FrameCost predictCost(const AccuracySurvey &survey, const Constitution &constitution, const CostSetting &setting,
                      double spacing) {
  const WorldSettings &world = setting.world;
  const double finer = survey.fine.spacing / spacing;
  const double phyxels = survey.phyxelsAt(spacing);
  const double points = static_cast<double>(survey.fine.points) * phyxels / static_cast<double>(survey.fine.phyxels);
  const double contacts = setting.contact ? static_cast<double>(survey.fine.contacts) * finer * finer : 0.0;
  const double stable = kStepSafety * survey.fine.stableStep / finer;
  const detail::StepCost evaluations = detail::predictCost(phyxels, stable, world.dt);
  const double evaluation_ns = materialFactor(constitution) * points * setting.speed.perPoint(points, world.precision);
  FrameCost out;
  out.step = world.dt > 0.0 ? std::min(world.dt, stable) : stable;
  const double explicit_ms = 1e-6 * kFrame / out.step * (evaluation_ns + contacts * setting.speed.contact_ns);
  const double implicit_ms = 1e-6 * kFrame * evaluations.implicitEvaluations * evaluation_ns;
  const double skin_ms = 1e-6 * setting.speed.surfel_ns * static_cast<double>(setting.surfels);
  out.integrator = world.integrator;
  if (world.integrator == Integrator::automatic)
    out.integrator = evaluations.explicitEvaluations <= evaluations.implicitEvaluations ? Integrator::explicitVerlet
                                                                                        : Integrator::implicitSdirk;
  switch (out.integrator) {
    case Integrator::explicitVerlet: out.ms = explicit_ms + skin_ms; break;
    case Integrator::quasiStatic: {
      const int increments = world.loadSteps > 0 ? world.loadSteps : 10;
      out.step = 0.0;
      out.ms = 1e-6 * increments * kEvaluationsPerIncrement * std::sqrt(phyxels / 500.0) * evaluation_ns;
      break;
    }
    default: out.step = world.dt > 0.0 ? world.dt : kImplicitStep; out.ms = implicit_ms + skin_ms;
  }
  return out;
}

SamplingChoice chooseSampling(const AccuracySurvey &survey, const Constitution &constitution,
                              const CostSetting &setting, const AccuracyWish &wish) {
  const double finest = survey.spacingFor(kMostPhyxelsOfDial), coarsest = survey.spacingFor(kFewest);
  const auto costAt = [&](double d) { return predictCost(survey, constitution, setting, d); };
  // Error grows and cost falls with the spacing: bisection for where a condition begins to hold or ends.
  const auto largestWhere = [&](const std::function<bool(double)> &good) {
    double low = finest, high = coarsest;
    if (good(high)) return high;
    for (int i = 0; i < 60; ++i) {
      const double mid = std::sqrt(low * high);
      (good(mid) ? low : high) = mid;
    }
    return low;
  };
  const auto smallestWhere = [&](const std::function<bool(double)> &good) {
    double low = finest, high = coarsest;
    if (good(low)) return low;
    for (int i = 0; i < 60; ++i) {
      const double mid = std::sqrt(low * high);
      (good(mid) ? high : low) = mid;
    }
    return high;
  };
  double share = kStandardError, budget = std::numeric_limits<double>::infinity();
  switch (wish.kind) {
    case AccuracyWish::Kind::standard: budget = kStandardBudget / std::max(1.0, wish.value); break;
    case AccuracyWish::Kind::share: share = wish.value; break;
    case AccuracyWish::Kind::length: share = survey.largest > 0.0 ? wish.value / survey.largest : 1.0; break;
    case AccuracyWish::Kind::budget:
      share = 0.0;
      budget = wish.value;
      break;
  }
  const bool isStatic = setting.world.integrator == Integrator::quasiStatic;
  const double forBudget = isStatic || !std::isfinite(budget)
                               ? finest
                               : smallestWhere([&](double d) { return 1e-3 * costAt(d).ms <= kBudgetToUse * budget; });
  // Who wishes wants to be sure of it; what nobody has wished for is to be so at even odds.
  const bool isSure = wish.kind != AccuracyWish::Kind::standard;
  const auto expected = [&](double d) {
    const ErrorPrediction error = predictError(survey, d);
    return isSure ? error.likely : error.share;
  };
  const double forError = largestWhere([&](double d) { return expected(d) <= share; });
  SamplingChoice out;
  out.spacing = std::max(forError, forBudget);
  if (wish.kind == AccuracyWish::Kind::standard)
    out.spacing =
        std::min(out.spacing, survey.spacingFor(static_cast<double>(automaticCount(survey.volume, survey.area))));
  out.count = static_cast<std::size_t>(std::lround(survey.phyxelsAt(out.spacing)));
  out.error = predictError(survey, out.spacing);
  out.largest = survey.largest;
  out.cost = costAt(out.spacing);
  if (wish.kind != AccuracyWish::Kind::budget && expected(out.spacing) > 1.001 * share)
    out.unmet = "an error of " + percent(share) + " cannot be had " +
                (forBudget > finest ? "within " + detail::number(1e3 * budget, 3) + " ms a frame"
                                    : "with up to " + detail::number(kMostPhyxelsOfDial, 6) + " phyxels") +
                "; expected are " + percent(out.error.share) + " with " + std::to_string(out.count);
  if (1e-3 * out.cost.ms > budget && !isStatic)
    out.unmet = detail::number(1e3 * budget, 3) + " ms a frame cannot be had; expected are " +
                detail::number(out.cost.ms, 3) + " ms with " + std::to_string(out.count) + " phyxels";
  return out;
}

}  // namespace pointbased
