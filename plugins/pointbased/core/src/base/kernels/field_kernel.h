// SPDX-License-Identifier: Apache-2.0
// Loops over the phyxels of a step that are no forces, over plain numbers x y z x y z. Private to the core.
#pragma once

#include <cstddef>

namespace pointbased::kernels {

/// v += h (m^-1 f + s g), rounded as the plain loop rounds it on every instruction set.
struct Kick {
  double h = 0.0;                         ///< s
  const double *inverseMasses = nullptr;  ///< [phyxels] 1/kg
  const double *gravityShares = nullptr;  ///< [phyxels], or null: ones
  double gravity[3] = {};                 ///< m/s²
  const double *forces = nullptr;         ///< [phyxels][3] N
  double *velocities = nullptr;           ///< [phyxels][3] in and out: m/s
};
/// Of the phyxels [begin, end); those of no inverse mass stay.
/// @threads any, disjoint ranges
void kick(const Kick &kick, std::size_t begin, std::size_t end);

/// a += s b over n numbers, likewise.
void addScaled(double s, const double *b, double *a, std::size_t n);

struct FieldBounds {
  double low[3], high[3];
  double sum = 0.0;  ///< no number where any is none
};
/// @param count  phyxels, > 0
[[nodiscard]] FieldBounds boundsOf(const double *field, std::size_t count);

/// In no fixed order: only to ask whether it is finite.
[[nodiscard]] double roughSumOfSquares(const double *numbers, std::size_t n);

}  // namespace pointbased::kernels
