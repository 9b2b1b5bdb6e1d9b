// SPDX-License-Identifier: Apache-2.0
#include "stepping/step_cost.h"

#include <algorithm>
#include <cmath>

#include "pointbased/world_settings.h"

namespace pointbased::detail {
namespace {

constexpr double kExplicitOverhead = 0.3;       // of an evaluation: integration, supports, the guard
constexpr double kImplicitEvaluations = 700.0;  // of a step of 500 phyxels

}  // namespace

StepCost predictCost(const Body &body, double dt) {
  StepCost cost;
  const double stable = kStepSafety * body.stableStepAtRest();
  const double explicitStep = dt > 0.0 ? std::min(dt, stable) : stable;
  const double implicitStep = dt > 0.0 ? dt : kImplicitStep;
  const double size = static_cast<double>(std::max<std::size_t>(1, body.rest().phyxelCount())) / 500.0;
  cost.explicitEvaluations = (1.0 + kExplicitOverhead) / explicitStep;
  cost.implicitEvaluations = kImplicitEvaluations * std::sqrt(size) / implicitStep;
  return cost;
}

}  // namespace pointbased::detail
