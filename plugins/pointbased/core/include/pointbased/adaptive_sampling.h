// SPDX-License-Identifier: Apache-2.0
// Finer cells where the error of a body arises.
#pragma once

#include <string>

#include "pointbased/accuracy.h"

namespace pointbased {

/// Where the cells of a lattice are halved, and what that promises.
struct AdaptiveSampling {
  LatticeSampling sampling;  ///< what was asked for, with about as many phyxels
  std::size_t halved = 0;    ///< cells; 0: those of one size serve as well
  std::size_t cells = 0;     ///< before they are halved
  /// Part of the squared error, in energy, that arises in those that are halved, or would have been
  double share = 0.0;
  /// About the largest stable explicit step at rest with cells of one size, as many phyxels, s; 0: not known
  double evenStep = 0.0;
  std::string uniform;  ///< why no cells are halved; else empty
};

/// Solves the body under its supports and loads by the linear law on a lattice of three fifths of the wanted phyxels,
/// asks each of its cells for its part of the error (estimateError()) and halves those that have most of it until the
/// count is met. A wanted spacing is that of the lattice, which gets two thirds more phyxels then.
///
/// Where a tenth of the cells has most of the squared error, halving them takes more of it away than cells that are 1.2
/// times finer everywhere: borders of what is held, led or loaded, thin necks, edges of stiff parts. Where the error is
/// even, the sampling stays what it is; the bound of `share` is from bench_dial --adaptive.
///
/// Errors: those of buildRestState(); no equilibrium. Costs a body of that size and a linear solution of it.
/// @threads  the same bits for any number of threads behind parallelFor
/// @source  Zienkiewicz and Zhu, A simple error estimator and adaptive procedure for practical engineering analysis,
///          IJNME 24, 1987; the choice between both samplings: own
[[nodiscard]] Result<AdaptiveSampling> adaptSampling(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                                     const StopRequest *stop = nullptr);

}  // namespace pointbased
