// SPDX-License-Identifier: Apache-2.0
// Solves with a sparse Cholesky factor for many right-hand sides. Private to the core.
#pragma once

#include <cstddef>

namespace pointbased::kernels {

/// Lower triangle L by columns, the diagonal first in each.
struct SparseFactor {
  std::size_t size = 0;
  const int *offsets = nullptr;  ///< [size + 1] into the following
  const int *rows = nullptr;
  const float *values = nullptr;
};

inline constexpr std::size_t kFactorColumns = 48;

/// x = (L L^T)^-1 x for kFactorColumns right-hand sides. The rounding differs between instruction sets.
/// @param x  [size][kFactorColumns]
/// @threads  any, each with its own x
void solveFactor(const SparseFactor &factor, float *x);

}  // namespace pointbased::kernels
