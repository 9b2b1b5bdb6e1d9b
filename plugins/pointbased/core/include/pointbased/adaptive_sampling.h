// SPDX-License-Identifier: Apache-2.0
// Refines cells where the error of a body originates.
#pragma once

#include <string>

#include "pointbased/accuracy.h"

namespace pointbased {

/// A locally refined sampling and its expected benefit.
struct AdaptiveSampling {
  LatticeSampling sampling;  ///< as requested, with about as many phyxels
  std::size_t halved = 0;    ///< number of cells; 0: uniform cells are as good
  std::size_t cells = 0;     ///< before refinement
  /// Fraction of the squared error, in energy, that originates in the halved cells, or in those that would have been
  /// halved
  double share = 0.0;
  /// Approximate largest stable explicit step at rest with as many phyxels in uniform cells, s; 0: unknown
  double evenStep = 0.0;
  std::string uniform;  ///< why no cells are halved; else empty
};

/// Solves the body under its supports and loads by the linear law on a lattice with three fifths of the target number
/// of phyxels. Evaluates the error of each cell (estimateError()) and halves those with the largest contributions until
/// the count is reached. A target spacing is that of the lattice, which gets two thirds more phyxels then.
///
/// Where a tenth of the cells has most of the squared error, halving them removes more of it than uniform cells that
/// are 1.2 times finer. Such cells are found at borders of held, moved or loaded parts, in thin necks, and at edges of
/// stiff parts. Where the error is even, the sampling is not changed; the bound of `share` is from bench_accuracy dial
/// --adaptive.
///
/// Errors: those of buildRestState(); no equilibrium.
///
/// Costs building a body of that size and one linear solution of it.
/// @threads  bitwise identical for any number of threads behind parallelFor
/// @source  Zienkiewicz and Zhu, A simple error estimator and adaptive procedure for practical engineering analysis,
///          IJNME 24, 1987; the choice between both samplings: own
[[nodiscard]] Result<AdaptiveSampling> adaptSampling(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                                     const StopRequest *stop = nullptr);

}  // namespace pointbased
