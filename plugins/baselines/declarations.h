// SPDX-License-Identifier: Apache-2.0
// What scenes can say to the baselines. A law, and a Poisson's ratio, that a method does not have is refused: who
// compares it says what it has.
#pragma once

#include <span>

#include "c3de/sdk/sdk.hpp"

namespace baselines {

inline constexpr std::string_view kLaw = "material.law", kReach = "sampling.reach", kLinear = "sampling.linear",
                                  kErrata = "sampling.formulas", kNeighbours = "sampling.neighbours",
                                  kTolerance = "solver.tolerance";

[[nodiscard]] std::span<const c3de_param_decl> worldOfBaselines();
[[nodiscard]] std::span<const c3de_param_decl> ofMassSprings();
[[nodiscard]] std::span<const c3de_param_decl> ofShapeMatching();
[[nodiscard]] std::span<const c3de_param_decl> ofTetrahedra();
[[nodiscard]] std::span<const c3de_param_decl> ofThesis();
[[nodiscard]] std::span<const c3de_param_decl> ofObstacles();

}  // namespace baselines
