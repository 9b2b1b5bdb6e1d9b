// SPDX-License-Identifier: Apache-2.0
#include "base/accuracy_target.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/number_text.h"
#include "base/placed_mesh.h"
#include "c3de/abi/iface/parameter_ids.h"
#include "c3de/sdk/commands.hpp"
#include "c3de/sdk/structs.hpp"

namespace pointbased {
namespace {

constexpr const char *kSpeedKey = "accuracy.machine_speed";
constexpr double kFinerThanSingle = 1e-3;  // of the largest displacement: targets below it require double precision

}  // namespace

bool isAccuracyTarget(std::string_view id) {
  return std::find(kAccuracyTargets.begin(), kAccuracyTargets.end(), id) != kAccuracyTargets.end();
}

sdk::Result<void> resolveAccuracyTarget(ParameterValues &world, const c3de_param_value *values, std::uint64_t n,
                                        std::uint64_t stride) {
  std::string_view last;
  for (std::uint64_t i = 0; i < n; ++i) {
    const std::string_view id = sdk::text(sdk::readElement(values, i, stride, "value").id);
    if (!isAccuracyTarget(id) || world.isAuto(id)) continue;
    if (!last.empty() && id != last)
      return sdk::Failure{C3DE_E_ARG, std::string(last) + " and " + std::string(id) +
                                          " are two wishes; accepted: one of them, the other \"auto\""};
    last = id;
  }
  if (last.empty()) return {};
  for (const std::string_view id : kAccuracyTargets)
    if (id != last) sdk::orThrow(world.set(sdk::textValue(id, "auto")));
  return {};
}

AccuracyTarget accuracyTargetOf(const ParameterValues &world) {
  const auto given = [&](const char *id) { return !world.isAuto(id); };
  const double bodies = std::max(1.0, world.number(C3DE_PARAM_ID_ACCURACY_BODIES));
  if (given(C3DE_PARAM_ID_ERROR_PERCENT))
    return {AccuracyTarget::Kind::share, 0.01 * world.number(C3DE_PARAM_ID_ERROR_PERCENT)};
  if (given(C3DE_PARAM_ID_ERROR_MM)) return {AccuracyTarget::Kind::length, 1e-3 * world.number(C3DE_PARAM_ID_ERROR_MM)};
  if (given(C3DE_PARAM_ID_BUDGET_MS))
    return {AccuracyTarget::Kind::budget, 1e-3 * world.number(C3DE_PARAM_ID_BUDGET_MS) / bodies};
  return {AccuracyTarget::Kind::standard, bodies};
}

std::string textOf(const AccuracyTarget &wish) {
  switch (wish.kind) {
    case AccuracyTarget::Kind::share: return "error_percent = " + shortNumber(100.0 * wish.value);
    case AccuracyTarget::Kind::length: return "error_mm = " + shortNumber(1e3 * wish.value);
    case AccuracyTarget::Kind::budget: return "budget_ms = " + shortNumber(1e3 * wish.value);
    case AccuracyTarget::Kind::standard: break;
  }
  return {};
}

bool isFarCoarserThanSingle(const AccuracyTarget &wish) {
  switch (wish.kind) {
    case AccuracyTarget::Kind::share: return wish.value >= kFinerThanSingle;
    case AccuracyTarget::Kind::budget: return true;
    default: return false;  // mm relative to a displacement that is unknown before the body is built
  }
}

const MachineSpeed &MachineSpeedCache::speed() {
  const std::lock_guard lock(mutex_);
  if (speed_) return *speed_;
  const sdk::Settings settings(host_);
  const ParallelFor loops = services_.parallelFor();
  const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
  if (settings)
    if (const auto kept = settings.get(kSpeedKey))
      if (auto speed = speedFrom(*kept); speed && matchesThisMachine(*speed, loops, threads))
        speed_ = std::move(*speed);
  if (speed_) return *speed_;
  speed_ = measureSpeed(loops, threads);
  services_.log.info("the speed of this machine was measured: " + shortNumber(speed_->double_ns[1]) +
                     " ns a step and point");
  if (settings)
    if (const auto done = settings.set(kSpeedKey, textOf(*speed_)); !done)
      services_.log.warn("the speed of this machine could not be kept: " + done.failure().message);
  return *speed_;
}

void refuseConflictingSampling(const std::string &name, const ParameterValues &body, const AccuracyTarget &wish) {
  if (wish.kind == AccuracyTarget::Kind::standard) return;
  for (const char *id : {"sampling.spacing", "sampling.count"})
    if (!body.isAuto(id))
      throw sdk::Error(C3DE_E_ARG, name + ": " + id + " and accuracy." + textOf(wish) +
                                       " both say how fine it is; accepted: one of them");
  if (body.text("sampling.evaluation") == "phyxels")
    throw sdk::Error(C3DE_E_ARG, name +
                                     ": sampling.evaluation = \"phyxels\" has no prediction of its error; accepted "
                                     "with accuracy." +
                                     textOf(wish) + ": \"auto\", \"stress_points\"");
}

void AccuracyPrediction::built(const RestState &rest) {
  choice.spacing = rest.spacing;
  choice.count = rest.phyxelCount();
  if (survey) choice.error = predictError(*survey, rest.spacing);
}

void AccuracyPrediction::measured(double ms) {
  if (!(ms > 0.0)) return;
  choice.frame_ms = ms;
  isMeasured = true;
  if (wish.kind != AccuracyTarget::Kind::budget) return;
  const double budget = 1e3 * wish.value;
  choice.unmet.clear();
  if (const double whole = ms + choice.touching_ms; whole > budget)
    choice.unmet = shortNumber(budget) + " ms a frame cannot be had; it takes " + twoDigits(whole) + " ms with " +
                   std::to_string(choice.count) + " phyxels" +
                   (choice.touching_ms > 0.0 ? " while a fifth of its skin touches other bodies" : "");
}

std::string adaptiveText(const AdaptiveSampling &adaptive) {
  if (adaptive.halved == 0) return "cells of one size: " + adaptive.uniform;
  return std::to_string(adaptive.halved) + " of " + std::to_string(adaptive.cells) + " cells halved, which had " +
         twoDigits(100.0 * adaptive.share) + " % of the squared error of a trial";
}

std::string addedMassText(const Body &body) {
  const auto [mass, phyxels] = body.addedMass();
  if (phyxels == 0) return "";
  double all = 0.0;
  for (std::size_t i = 0; i < body.restMasses().size(); ++i)
    if (body.inverseMasses()[i] > 0.0) all += body.restMasses()[i];
  return twoDigits(1e3 * mass) + " g, " + twoDigits(100.0 * mass / all) + " % of what can move, to " +
         std::to_string(phyxels) + " phyxels";
}

std::string touchingText(const AccuracyPrediction &promise) {
  return twoDigits(promise.choice.touching_ms) + " ms more while a fifth of its skin touches other bodies";
}

std::string noticeOf(const std::string &name, const AccuracyPrediction &promise) {
  const std::string who = "body '" + name + "': ";
  const bool isWished = promise.wish.kind != AccuracyTarget::Kind::standard;
  if (!promise.survey)
    return isWished ? who + "no sampling could be chosen for " + textOf(promise.wish) + ": " + promise.unpredicted
                    : std::string();
  if (!isWished && promise.choice.unmet.empty()) return {};
  std::string text = who + "sampled with " + std::to_string(promise.choice.count) + " phyxels" +
                     (promise.choice.order == LatticeOrder::quadratic ? " of second order" : "") +
                     (isWished ? " for " + textOf(promise.wish) : std::string()) + ", " +
                     twoDigits(promise.choice.frame_ms) + " ms a frame";
  if (promise.choice.touching_ms > 0.0) text += ", " + touchingText(promise);
  if (!promise.choice.unmet.empty()) text += "; " + promise.choice.unmet;
  return text;
}

}  // namespace pointbased
