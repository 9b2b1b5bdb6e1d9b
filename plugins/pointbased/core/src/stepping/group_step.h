// SPDX-License-Identifier: Apache-2.0
// Implicit and static steps of several bodies together; integrators.h has those of one. Private to the core.
#pragma once

#include "pointbased/integrators.h"
#include "stepping/stage_coupling.h"

namespace pointbased::detail {

/// A body that a step moves, and what it needs from outside.
struct StepPart {
  Body *body = nullptr;
  const Environment *environment = nullptr;
};

/// As implicitStep() and quasiStaticStep(); NewtonResult::worst counts the phyxels of all parts.
/// @param coupling  of the parts and of those that stand still; null: of one body alone
[[nodiscard]] ImplicitResult implicitStep(std::span<const StepPart> parts, StageCoupling *coupling,
                                          NewtonSolver &solver, double time, double dt, Integrator scheme);
[[nodiscard]] ImplicitResult quasiStaticStep(std::span<const StepPart> parts, StageCoupling *coupling,
                                             NewtonSolver &solver, double from, double to,
                                             const std::function<bool()> &shouldContinue);

}  // namespace pointbased::detail
