// SPDX-License-Identifier: Apache-2.0
// Predicted cost of a simulated second of a body, explicit and implicit. Private to the core.
#pragma once

#include "pointbased/body.h"

namespace pointbased::detail {

/// Evaluations of the body's forces per simulated second; independent of the machine.
struct StepCost {
  double explicitEvaluations = 0.0;
  double implicitEvaluations = 0.0;
  [[nodiscard]] bool implicitIsCheaper() const { return implicitEvaluations < explicitEvaluations; }
};

/// Approximate ratio by which contact increases the cost of implicit steps more than that of explicit ones. Two blocks
/// of 1 331 phyxels that are pressed together cost 13 … 35 times as much as apart in implicit steps, 9 times in
/// explicit ones (bench_contact --pressed).
inline constexpr double kImplicitContact = 2.0;

/// Explicit: the substeps that the stable step at rest requires, each an evaluation and kExplicitOverhead. Implicit:
/// steps of dt (or 1/60 s) of a lattice of any size, fitted to SDIRK2 of held beams without contact of 3 000 and 10 000
/// phyxels at 1 MPa, where the choice is made: 170 and 200, 250 and 300, 450 and 540 evaluations at ν = 0.3, 0.45 and
/// 0.49, because the linear solver needs more iterations. For clouds the evaluations grow with the root of their size.
/// @param dt  s; <= 0: automatic
[[nodiscard]] StepCost predictCost(const Body &body, double dt);
/// Same for a body that does not exist yet.
/// @param stable          s, its explicit step
/// @param phyxelsOfCloud  0: a lattice
[[nodiscard]] StepCost predictCost(double stable, double dt, const Constitution &constitution,
                                   double phyxelsOfCloud = 0.0);

}  // namespace pointbased::detail
