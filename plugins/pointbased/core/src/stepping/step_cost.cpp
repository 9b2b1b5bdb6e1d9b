// SPDX-License-Identifier: Apache-2.0
#include "stepping/step_cost.h"

#include <algorithm>
#include <cmath>

#include "pointbased/world_settings.h"

namespace pointbased::detail {
namespace {

constexpr double kExplicitOverhead = 0.3;       // of an evaluation: integration, supports, the guard
constexpr double kImplicitEvaluations = 700.0;  // of a step of a lattice of any size, or of a cloud of 500 phyxels

}  // namespace

StepCost predictCost(const Body &body, double dt) {
  const bool isCloud = body.rest().evaluation == Evaluation::phyxels;
  return predictCost(kStepSafety * body.stableStepAtRest(), dt,
                     isCloud ? static_cast<double>(body.rest().phyxelCount()) : 0.0);
}

StepCost predictCost(double stable, double dt, double phyxelsOfCloud) {
  StepCost cost;
  const double explicitStep = dt > 0.0 ? std::min(dt, stable) : stable;
  const double implicitStep = dt > 0.0 ? dt : kImplicitStep;
  cost.explicitEvaluations = (1.0 + kExplicitOverhead) / explicitStep;
  cost.implicitEvaluations = kImplicitEvaluations * std::sqrt(std::max(1.0, phyxelsOfCloud / 500.0)) / implicitStep;
  return cost;
}

}  // namespace pointbased::detail
