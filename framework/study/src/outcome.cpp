// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/outcome.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <thread>

#include "c3de/core/platform.h"
#include "c3de/core/text.h"
#include "c3de/study/pareto.h"

namespace c3de::study {
namespace {

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

Cost costOf(const Result &result) {
  const auto of = [&](double Result::Run::*time, double factor = 1.0) {
    std::vector<double> values;
    for (const Result::Run &run : result.runs) values.push_back(factor * (run.*time));
    return values;
  };
  const std::vector<double> costs = of(&Result::Run::wall_s, 1e3 / (result.time_s > 0.0 ? result.time_s : 1.0));
  return {*std::min_element(costs.begin(), costs.end()),
          medianOf(costs),
          *std::max_element(costs.begin(), costs.end()),
          medianOf(of(&Result::Run::stepMedian_ms)),
          medianOf(of(&Result::Run::step99_ms)),
          medianOf(of(&Result::Run::stepMax_ms)),
          medianOf(of(&Result::Run::cpu_s)),
          medianOf(of(&Result::Run::toFirstStep_s))};
}

/// The limit of the runs of a reference.
Expected<ReferenceSolution> referenceOfRuns(const Plan &plan, std::size_t c, const Case &one, const Samples &samples,
                                            const std::map<std::string, Result> &results) {
  std::array<Result, 3> runs;
  std::array<double, 3> spacings{};
  std::size_t i = 0;
  for (const Point &point : plan.points) {
    if (point.ofCase != c || !point.isReference || i == 3) continue;
    const auto found = results.find(point.id);
    const std::string which = "the run of the reference with " + shown(point.parameters);
    if (found == results.end()) return fail(ErrorCode::state, which + " is missing");
    if (!found->second.failure.empty())
      return fail(ErrorCode::state, which + " " + found->second.failure + ": " + found->second.reason);
    runs[i] = found->second;
    spacings[i] = refinementOf(point.parameters.front());
    // The actual spacing, also for a count, is reported by the simulator.
    const auto &parameter = point.parameters.front().parameter;
    if (parameter == "count" || parameter == "spacing")
      for (const Result::Body &body : runs[i].bodies)
        if (body.name == plan.cases[c].bodies.front() && body.spacing_m > 0.0) spacings[i] = body.spacing_m;
    ++i;
  }
  if (!(spacings[0] > spacings[1] && spacings[1] > spacings[2]))
    return fail(ErrorCode::state, "the runs of the reference do not become finer: their spacings are " +
                                      formatNumber(spacings[0]) + ", " + formatNumber(spacings[1]) + ", " +
                                      formatNumber(spacings[2]) + " m");
  return extrapolatedReference(one, samples, spacings, runs);
}

/// Message if the bar of three runs is a large part of the errors.
std::string resolutionTooLarge(const Case &one, const ReferenceSolution &truth, std::vector<double> errors) {
  if (one.reference.source != Reference::Source::richardson || errors.empty()) return {};
  const double median = medianOf(std::move(errors));
  if (truth.bar <= one.reference.share * median) return {};
  return "the reference is too uncertain: its bar of " + formatNumber(truth.bar) + " is more than " +
         formatNumber(one.reference.share) + " of the median error of " + formatNumber(median) +
         "; finer 'values', or a larger 'share', would help";
}

std::string today() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::array<char, 32> text{};
  std::tm utc{};
#ifdef _WIN32
  gmtime_s(&utc, &now);
#else
  gmtime_r(&now, &utc);
#endif
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &utc);
  return text.data();
}

void markFront(const Plan &plan, std::size_t c, double bar, std::vector<PointOutcome> &points) {
  std::vector<Tradeoff> tradeoffs;
  std::vector<std::size_t> which;
  for (std::size_t p = 0; p < points.size(); ++p) {
    PointOutcome &point = points[p];
    if (plan.points[p].ofCase != c || plan.points[p].isReference || !point.cost || !point.errors.quantity) continue;
    tradeoffs.push_back({point.cost->cheapest, point.cost->dearest, *point.errors.quantity});
    which.push_back(p);
    point.isBelowResolution = *point.errors.quantity < bar;
  }
  const std::vector<bool> front = paretoFront(tradeoffs, bar);
  for (std::size_t i = 0; i < which.size(); ++i) points[which[i]].isOnFront = front[i];
}

}  // namespace

Outcome evaluate(const Study &study, const Plan &plan, std::vector<Samples> samples,
                 const std::map<std::string, Result> &results) {
  Outcome out;
  out.cpu = cpuName();
  out.host = hostName();
  out.processors = std::thread::hardware_concurrency();
  out.date = today();
  out.cases.resize(study.cases.size());
  out.points.resize(plan.points.size());
  for (std::size_t c = 0; c < study.cases.size(); ++c) {
    const Case &one = study.cases[c];
    auto truth = one.reference.source == Reference::Source::richardson
                     ? referenceOfRuns(plan, c, one, samples[c], results)
                     : statedReference(study, one, samples[c]);
    if (!truth) out.cases[c].error = truth.error().message;
    std::vector<double> errors;
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      if (plan.points[p].ofCase != c) continue;
      PointOutcome &point = out.points[p];
      const auto found = results.find(plan.points[p].id);
      if (found == results.end()) {
        point.failure = "missing";
        point.reason = "it has not been run";
        continue;
      }
      const Result &result = found->second;
      point.failure = result.failure;
      point.reason = result.reason;
      if (!point.failure.empty()) continue;
      point.cost = costOf(result);
      point.steps = result.steps;
      point.time_s = result.time_s;
      point.dt_s = result.dt_s;
      point.integrator = result.integrator;
      point.stateHash = result.stateHash;
      if (!plan.points[p].isReference) out.cases[c].hasTime = point.time_s > 0.0;
      point.errors = errorsOf(one, plan.points[p], truth.value_or(ReferenceSolution{}), samples[c], result);
      if (const auto value = one.quantity.isField() ? Expected<double>(0.0) : valueOf(one.quantity, result); !value) {
        point.failure = "failed";
        point.reason = value.error().message;
      }
      if (point.errors.quantity && !plan.points[p].isReference) errors.push_back(*point.errors.quantity);
    }
    if (!truth) continue;
    out.cases[c].error = resolutionTooLarge(one, *truth, std::move(errors));
    out.cases[c].truth = std::move(*truth);
    markFront(plan, c, out.cases[c].truth->bar, out.points);
  }
  return out;
}

std::optional<double> costRatio(const Plan &plan, const Outcome &outcome, std::size_t ofCase) {
  std::vector<double> ratios;
  for (std::size_t p = 0; outcome.earlier && p < plan.points.size(); ++p)
    if (const auto &before = outcome.earlier->points[p];
        before && plan.points[p].ofCase == ofCase && outcome.points[p].cost && before->cost_ms > 0.0)
      ratios.push_back(outcome.points[p].cost->median / before->cost_ms);
  if (ratios.empty()) return {};
  std::sort(ratios.begin(), ratios.end());
  return 0.5 * (ratios[(ratios.size() - 1) / 2] + ratios[ratios.size() / 2]);
}

}  // namespace c3de::study
