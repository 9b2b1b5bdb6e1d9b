// SPDX-License-Identifier: Apache-2.0
// Forces and energies of lattice cells with plastic flow or relaxation. Private to the core.
#pragma once

#include "slices.h"

namespace pointbased::kernels {

/// Same as cellForces(), with plastic flow first, the elastic law on F F_p^-1, and Prony terms of the stress and of the
/// modes. Advances the history of the cells by one step.
/// @threads  any, disjoint ranges of chunks; no allocation; bits as cellForces()
void cellHistoryForces(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                       std::size_t begin, std::size_t end);

/// Same as cellEnergies(), for the elastic strain; the history is not changed.
void cellHistoryEnergies(const CellJob<double> &job, const HistoryJob &history, const ScalarLaw &scalar,
                         std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
