// SPDX-License-Identifier: Apache-2.0
// Vector operations over phyxels, on plain numbers x y z x y z. Private to the core.
#pragma once

#include <cstddef>

namespace pointbased::kernels {

/// v += h (m^-1 f + s g), with the same rounding as the scalar loop on every instruction set.
struct Kick {
  double h = 0.0;                         ///< s
  const double *inverseMasses = nullptr;  ///< [phyxels] 1/kg
  const double *gravityShares = nullptr;  ///< [phyxels], or null: 1
  double gravity[3] = {};                 ///< m/s²
  const double *forces = nullptr;         ///< [phyxels][3] N
  double *velocities = nullptr;           ///< [phyxels][3] in and out: m/s
};
/// Applies to the phyxels [begin, end); those with zero inverse mass are not changed.
/// @threads  any, disjoint ranges
void kick(const Kick &kick, std::size_t begin, std::size_t end);

/// a += s b over n numbers, with the same guarantee.
void addScaled(double s, const double *b, double *a, std::size_t n);

struct FieldBounds {
  double low[3], high[3];
  double sum = 0.0;  ///< NaN if any value is NaN
};
/// @param count  phyxels, > 0
[[nodiscard]] FieldBounds boundsOf(const double *field, std::size_t count);

/// Sum in unspecified order: only for a check of finiteness.
[[nodiscard]] double roughSumOfSquares(const double *numbers, std::size_t n);

}  // namespace pointbased::kernels
