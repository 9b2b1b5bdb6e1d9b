// SPDX-License-Identifier: Apache-2.0
// Forces and energies of lattice cells that flow or relax. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// As cellForces(), with the elastic law on F F_p^-1, Prony terms of the stress and of the modes, and plastic flow
/// before. The memory of the cells goes a step further with it, once.
/// @threads any, disjoint ranges of chunks; no allocation; bits as cellForces()
void cellHistoryForces(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);

/// As cellEnergies(), of the elastic strain; the memory stays.
void cellHistoryEnergies(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
