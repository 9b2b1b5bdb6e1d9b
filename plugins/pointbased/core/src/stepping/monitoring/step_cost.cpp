// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/step_cost.h"

#include <algorithm>
#include <cmath>

#include "pointbased/world_settings.h"

namespace pointbased::detail {
namespace {

constexpr double kExplicitOverhead = 0.3;     // of an evaluation: integration, supports, the guard
constexpr double kImplicitOfLattice = 150.0;  // evaluations per step, times
constexpr double kByCompressibility = -0.3;   // (1 - 2ν) to this power
constexpr double kImplicitOfCloud = 700.0;    // of 500 phyxels
constexpr double kMinCompressibility = 1e-4;  // smallest 1 - 2ν

}  // namespace

StepCost predictCost(const Body &body, double dt) {
  const bool isCloud = body.rest().evaluation == Evaluation::phyxels;
  return predictCost(kStepSafety * body.stableStepAtRest(), dt, body.constitution(),
                     isCloud ? static_cast<double>(body.rest().phyxelCount()) : 0.0);
}

StepCost predictCost(double stable, double dt, const Constitution &constitution, double phyxelsOfCloud) {
  double compressibility = 1.0;
  for (const Material &m : constitution.materials)
    compressibility = std::min(compressibility, 1.0 - 2.0 * m.poissonRatio);
  const double ofStep =
      phyxelsOfCloud > 0.0
          ? kImplicitOfCloud * std::sqrt(std::max(1.0, phyxelsOfCloud / 500.0))
          : kImplicitOfLattice * std::pow(std::max(kMinCompressibility, compressibility), kByCompressibility);
  StepCost cost;
  cost.explicitEvaluations = (1.0 + kExplicitOverhead) / (dt > 0.0 ? std::min(dt, stable) : stable);
  cost.implicitEvaluations = ofStep / (dt > 0.0 ? dt : kImplicitStep);
  return cost;
}

}  // namespace pointbased::detail
