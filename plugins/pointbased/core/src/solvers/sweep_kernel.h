// SPDX-License-Identifier: Apache-2.0
// Gauss-Seidel by 3x3 blocks over rows of a symmetric matrix. Private to the core.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pointbased::kernels {

/// Blocks of a row are stored in groups of eight, so that a vector contains one number of eight neighbours: those
/// before the diagonal, then those after it, each part padded with zeros. Blocks are of D^-1/2 A D^-1/2, D the
/// diagonal, between -1 and 1, in units of kUnit.
struct SweepRows {
  static constexpr std::size_t kEight = 8;
  static constexpr float kUnit = 1.0F / 32767.0F;

  const std::int16_t *blocks = nullptr;    ///< [eights][9][8]: by columns of the blocks
  const std::uint32_t *columns = nullptr;  ///< [eights][8]
  const std::uint32_t *eights =
      nullptr;                      ///< [2 nodes + 1]: of node i those before begin at 2 i, those after at 2 i + 1
  const float *inverses = nullptr;  ///< [nodes][12]: of the diagonal blocks, columns of four
  const float *right = nullptr;     ///< [nodes][4]
  float *x = nullptr;               ///< [nodes][4]
};

/// Updates x of the nodes [begin, end), first to last, with the contributions of nodes before each: later ones have not
/// moved yet.
/// @threads  any whose nodes are not neighbours; no allocation; the same bits on one machine for any division
void sweepForwards(const SweepRows &rows, std::size_t begin, std::size_t end);
/// Updates x of the nodes [begin, end), last to first, with the contributions of all others.
void sweepBackwards(const SweepRows &rows, std::size_t begin, std::size_t end);
/// out = remaining right-hand side after a forward sweep: -Σ over the nodes after each. [nodes][4]
void residualsAfter(const SweepRows &rows, float *out, std::size_t begin, std::size_t end);

}  // namespace pointbased::kernels
