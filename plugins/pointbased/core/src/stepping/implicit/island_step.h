// SPDX-License-Identifier: Apache-2.0
// Implicit and static steps of several bodies together; for a single body see integrators.h. Private to the core.
#pragma once

#include "pointbased/integrators.h"
#include "stepping/implicit/stage_coupling.h"

namespace pointbased::detail {

/// A body that a step moves, with its environment.
struct StepPart {
  Body *body = nullptr;
  const Environment *environment = nullptr;
};

/// Same as implicitStep() and quasiStaticStep() for several bodies; NewtonResult::worst counts the phyxels of all
/// parts.
/// @param coupling  of the parts and of static bodies; null: a single body
[[nodiscard]] ImplicitResult implicitStep(std::span<const StepPart> parts, StageCoupling *coupling,
                                          NewtonSolver &solver, double time, double dt, Integrator scheme);
[[nodiscard]] ImplicitResult quasiStaticStep(std::span<const StepPart> parts, StageCoupling *coupling,
                                             NewtonSolver &solver, double from, double to,
                                             const std::function<bool()> &shouldContinue);

}  // namespace pointbased::detail
