// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator.h"

namespace baselines {

using namespace mass_spring;

/// Moves the free points of a body to where no force is left: accelerated descent along the forces, each over the
/// stiffness of its point, begun anew whenever it goes uphill. What is held goes where its motion leads.
/// @param ofWorld  "solver.tolerance": the part of what supports, loads and gravity bear that may be left
/// @throws sdk::Error  C3DE_E_DIVERGED: no rest within 200 000 evaluations
/// @source  Y. Nesterov, Soviet Math. Dokl. 27 (1983); B. O'Donoghue, E. Candès, Found. Comput. Math. 15 (2015),
///          restart by the gradient
void relax(PointBody &body, const Loading &loading, const ParameterValues &ofWorld);

}  // namespace baselines
