// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/number_text.h"
#include "discretisation/lattice/lattice_direction.h"
#include "forces/vector_forces_parts.h"
#include "pointbased/accuracy.h"
#include "pointbased/sampling.h"
#include "shape/volume_moments.h"
#include "stepping/monitoring/step_cost.h"

namespace pointbased {
namespace {

// Fitted to random bodies, bench_accuracy dial --fit 30 [--second-order]:
// log error = constant + difference log(hypot(d_trials, kOrderDifferenceWeight d_orders))
//             + order log(spacing / spacing of the fine trial)
struct ErrorModel {
  double constant, difference, order;  // `difference` and `order` are exponents
  double spread;                       // standard deviation of log error near the fine trial
};
constexpr ErrorModel kFirstOrder{0.08, 1.14, 0.98, 0.41}, kSecondOrder{-0.41, 1.02, 1.31, 0.62};
constexpr double kOrderDifferenceWeight = 0.5;
constexpr double kSpreadPerLog = 0.3;  // additional, per log(spacing ratio), towards finer spacings
constexpr double kSpreadBeyond = 0.6;  // additional, per log(spacing ratio), towards spacings coarser than any trial
constexpr double kNineOfTen = 1.645;   // standard deviations, both sides
constexpr double kMinDifference = 1e-5;
// Time of an implicit step in contact, relative to one without contact: bench_contact --pressed, 13 … 31.
constexpr double kTouchingImplicitly = 20.0;
// Evaluations of a quasi-static solution: 650 to 1000 in one increment (bench_newton), 1200 to 2300 of a cantilever of
// 500 to 10 000 phyxels in ten.
constexpr double kEvaluationsToRest = 600.0, kEvaluationsPerIncrement = 120.0;
// Additional time of a quadratic point, in points: forces take 2.5 times as long where four fifths of the points are
// quadratic, and 2.4 times where six tenths are (test_pointbased "cost of second order").
constexpr double kExtraCostOfQuadraticPoint = 2.0;
constexpr double kWorthwhile = 0.8;  // part of the time, or of the error, that second order may have to be preferred

/// Relative time of a substep for materials with history, or with a law that is not one of the kernels' (bench_scaling,
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

struct Limits {
  double share = kStandardError;                            // of the largest displacement
  double budget = std::numeric_limits<double>::infinity();  // s
};

Limits limitsOf(const AccuracyTarget &target, const AccuracySurvey &survey) {
  Limits out;
  switch (target.kind) {
    case AccuracyTarget::Kind::standard: out.budget = kStandardBudget / std::max(1.0, target.value); break;
    case AccuracyTarget::Kind::share: out.share = target.value; break;
    case AccuracyTarget::Kind::length: out.share = survey.largest > 0.0 ? target.value / survey.largest : 1.0; break;
    case AccuracyTarget::Kind::budget: out = {0.0, target.value}; break;
  }
  return out;
}

/// The spacing nearest to `from` at which a condition holds. The condition must hold from some spacing on towards `to`.
/// Returns `to` if it holds nowhere.
double firstGood(double from, double to, const std::function<bool(double)> &isGood) {
  if (isGood(from)) return from;
  for (int i = 0; i < 60; ++i) {
    const double mid = std::sqrt(from * to);
    (isGood(mid) ? to : from) = mid;
  }
  return to;
}

std::string percent(double share) { return detail::number(100.0 * share, 2) + " %"; }

std::string errorUnmet(const SamplingChoice &choice, const Limits &limits, bool isLimitedByTime) {
  return "an error of at most " + percent(limits.share) + " is not sure to be had " +
         (isLimitedByTime ? "within " + detail::number(1e3 * limits.budget, 3) + " ms a frame"
                          : "with up to " + detail::number(kMaxChosenPhyxels, 6) + " phyxels") +
         "; expected are " + percent(choice.error.share) + " with " + std::to_string(choice.count);
}

}  // namespace

ErrorPrediction predictError(const AccuracySurvey &survey, double spacing) {
  const ErrorModel &model = survey.fine.quadraticPoints > 0 ? kSecondOrder : kFirstOrder;
  const double ratio = std::log(spacing / survey.fine.spacing);
  const double difference = std::hypot(survey.difference, kOrderDifferenceWeight * survey.orderDifference);
  const double log =
      model.constant + model.difference * std::log(std::max(difference, kMinDifference)) + model.order * ratio;
  const double beyond = std::max(0.0, std::log(spacing / survey.coarse.spacing));
  const double spread = model.spread + kSpreadPerLog * std::max(0.0, -ratio) + kSpreadBeyond * beyond;
  ErrorPrediction out;
  out.share = std::exp(log);
  out.low = std::exp(log - kNineOfTen * spread);
  out.high = std::exp(log + kNineOfTen * spread);
  out.likely = std::exp(log + spread);
  return out;
}

namespace {

// Cost of a frame of a moving body, itemised.
struct Frame {
  double contacts = 0.0;
  double evaluation_ms = 0.0;
  double substeps = 0.0;  // of explicit steps
  double stepped_ms = 0.0;
  bool isExplicit = false;
};

Frame frameAt(const AccuracySurvey &survey, const Constitution &constitution, const CostSetting &setting,
              double spacing) {
  const WorldSettings &world = setting.world;
  const double finer = survey.fine.spacing / spacing;
  Frame frame;
  // The number of quadratic points grows as that of cut cells, as d^-2.
  const double points =
      static_cast<double>(survey.fine.points) * survey.phyxelsAt(spacing) / static_cast<double>(survey.fine.phyxels) +
      kExtraCostOfQuadraticPoint * static_cast<double>(survey.fine.quadraticPoints) * finer * finer;
  frame.contacts = static_cast<double>(survey.fine.contacts) * finer * finer;
  const double stable = kStepSafety * survey.fine.stableStep / finer;
  frame.evaluation_ms = 1e-6 * materialFactor(constitution) * points * setting.speed.perPoint(points, world.precision);
  frame.substeps = kFrame / (world.dt > 0.0 ? std::min(world.dt, stable) : stable);
  const detail::StepCost evaluations = detail::predictCost(stable, world.dt, constitution);
  frame.isExplicit = world.integrator == Integrator::explicitVerlet ||
                     (world.integrator == Integrator::automatic && !evaluations.implicitIsCheaper());
  const double walls_ms = setting.contact ? 1e-6 * frame.contacts * setting.speed.contact_ns : 0.0;
  frame.stepped_ms = frame.isExplicit ? frame.substeps * (frame.evaluation_ms + walls_ms)
                                      : kFrame * evaluations.implicitEvaluations * frame.evaluation_ms;
  return frame;
}

}  // namespace

double predictCost(const AccuracySurvey &survey, const Constitution &constitution, const CostSetting &setting,
                   double spacing) {
  const WorldSettings &world = setting.world;
  const Frame frame = frameAt(survey, constitution, setting, spacing);
  if (world.integrator == Integrator::quasiStatic) {
    const int increments = world.loadSteps > 0 ? world.loadSteps : 10;
    return (kEvaluationsToRest + increments * kEvaluationsPerIncrement) * frame.evaluation_ms;
  }
  return frame.stepped_ms + 1e-6 * setting.speed.surfel_ns * static_cast<double>(setting.surfels);
}

double predictTouching(const AccuracySurvey &survey, const Constitution &constitution, const CostSetting &setting,
                       double spacing) {
  if (!setting.touches || setting.world.integrator == Integrator::quasiStatic) return 0.0;
  const Frame frame = frameAt(survey, constitution, setting, spacing);
  // Skins collide with all vertices that are drawn, and with more where triangles are larger than cells.
  const double vertices = kTouched * std::max(frame.contacts, static_cast<double>(setting.surfels));
  const double explicit_ms = frame.substeps * 1e-6 * vertices * setting.speed.touch_ns;
  if (frame.isExplicit) return explicit_ms;
  const double implicit_ms = (kTouchingImplicitly - 1.0) * frame.stepped_ms;
  // Touching bodies are integrated by the method that costs less for all.
  if (setting.world.integrator != Integrator::automatic) return implicit_ms;
  return std::max(0.0, std::min(implicit_ms, explicit_ms + frame.substeps * frame.evaluation_ms - frame.stepped_ms));
}

SamplingChoice chooseSampling(const AccuracySurvey &survey, const Constitution &constitution,
                              const CostSetting &setting, const AccuracyTarget &target) {
  const Limits limits = limitsOf(target, survey);
  const bool isStatic = setting.world.integrator == Integrator::quasiStatic;
  // An explicit accuracy target has to be met with confidence; the default is met at even odds.
  const bool isSure = target.kind != AccuracyTarget::Kind::standard;
  const auto errorAt = [&](double d) {
    const ErrorPrediction error = predictError(survey, d);
    return isSure ? error.likely : error.share;
  };
  const auto costAt = [&](double d) { return predictCost(survey, constitution, setting, d); };
  // The default is chosen as if nothing touched.
  const auto touchingAt = [&](double d) { return isSure ? predictTouching(survey, constitution, setting, d) : 0.0; };
  const double finest = survey.spacingFor(kMaxChosenPhyxels);
  double forBudget = finest;
  if (!isStatic && std::isfinite(limits.budget))
    forBudget = firstGood(finest, survey.spacingFor(kMinChosenPhyxels),
                          [&](double d) { return 1e-3 * (costAt(d) + touchingAt(d)) <= kBudgetToUse * limits.budget; });
  // No coarser than the trial: that costs almost nothing.
  const double forError =
      firstGood(survey.coarse.spacing, finest, [&](double d) { return errorAt(d) <= limits.share; });
  SamplingChoice out;
  out.order = survey.order;
  out.spacing = std::max(forError, forBudget);
  if (!isSure) {
    const auto least = static_cast<double>(automaticCount(survey.volume, survey.area));
    out.spacing = std::min(out.spacing, survey.spacingFor(least));
  }
  out.count = static_cast<std::size_t>(std::lround(survey.phyxelsAt(out.spacing)));
  out.error = predictError(survey, out.spacing);
  out.largest = survey.largest;
  out.frame_ms = costAt(out.spacing);
  out.touching_ms = predictTouching(survey, constitution, setting, out.spacing);
  const double whole_ms = out.frame_ms + touchingAt(out.spacing);
  out.isInTime = isStatic || 1e-3 * whole_ms <= limits.budget;
  if (target.kind != AccuracyTarget::Kind::budget && errorAt(out.spacing) > 1.001 * limits.share)
    out.unmet = errorUnmet(out, limits, forBudget > finest);
  if (!out.isInTime)
    out.unmet = detail::number(1e3 * limits.budget, 3) + " ms a frame cannot be had; expected are " +
                detail::number(whole_ms, 3) + " ms with " + std::to_string(out.count) + " phyxels";
  return out;
}

bool suitsSecondOrder(const Constitution &constitution) {
  return constitution.materials.size() == 1 && !constitution.hasHistory() &&
         detail::kernelKnows(constitution.materials.front());
}

bool suggestsSecondOrder(const BodyShape &shape, const BodyRecipe &recipe, const Constitution &constitution) {
  constexpr double kElongated = 4.0, kOblique = 0.05;
  const LatticeSampling &sampling = recipe.sampling;
  if (!suitsSecondOrder(constitution) || sampling.jitter > 0.0 || sampling.surfaceSpacing > 0.0 ||
      !sampling.refinements.empty() || shape.surface.triangles.empty())
    return false;
  std::vector<Region> held;
  for (const Fix &fix : recipe.fixes) held.push_back(fix.region);
  const Mat3 axes = sampling.axes ? *sampling.axes : lattice::latticeDirection(shape, held);
  if (!(lattice::misalignment(shape.surface, axes) > kOblique)) return false;
  const Vec3 edges = detail::momentsOfLargestPart(shape.surface).boxEdges();
  return edges[2] >= kElongated * edges[0];
}

bool mayNeedSecondOrder(const AccuracySurvey &survey, const SamplingChoice &first, const Constitution &constitution,
                        const AccuracyTarget &target) {
  if (survey.order != LatticeOrder::linear || !suitsSecondOrder(constitution)) return false;
  if (target.kind == AccuracyTarget::Kind::budget || !first.unmet.empty()) return true;
  std::size_t cheap = survey.fine.phyxels;
  if (target.kind == AccuracyTarget::Kind::standard)
    cheap = std::max(cheap, automaticCount(survey.volume, survey.area));
  return first.count > cheap;
}

bool prefersSecondOrder(const SamplingChoice &first, const SamplingChoice &second, const AccuracyTarget &target) {
  const bool isMet = first.unmet.empty(), isMetBySecond = second.unmet.empty();
  const double time = first.frame_ms + first.touching_ms, ofSecond = second.frame_ms + second.touching_ms;
  if (isMet != isMetBySecond) return isMetBySecond;
  if (isMet && target.kind != AccuracyTarget::Kind::budget) return ofSecond < kWorthwhile * time;
  if (first.isInTime != second.isInTime) return second.isInTime;
  if (!first.isInTime) return ofSecond < time;
  return second.error.share < kWorthwhile * first.error.share;
}

}  // namespace pointbased
