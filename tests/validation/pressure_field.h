// SPDX-License-Identifier: Apache-2.0
// The pressure of a solved body cell by cell, and its roughness.
#pragma once

#include "solved_body.h"

namespace validation {

/// Components of the pressure that change sign from cell to cell, relative to the pressure itself. For smooth fields
/// they come from third and higher derivatives and fall with the square of the spacing or faster; a checkerboard
/// remains.
struct Roughness {
  double pressure = 0.0;      ///< Pa, root mean square of p over the evaluated cells
  double checkerboard = 0.0;  ///< (-1)^(i+j+k): root mean square over that of p
  double planes = 0.0;        ///< the worst of (-1)^(i+j), (-1)^(i+k), (-1)^(j+k), normalised in the same way
  double lines = 0.0;         ///< the worst of (-1)^i, (-1)^j, (-1)^k, normalised in the same way
  double offLinear = 0.0;     ///< p minus the linear fit of its 27 cells, normalised in the same way
  double correlation = 0.0;   ///< of p minus the fit with the one pattern (-1)^(i+j+k) of the whole body, -1 … 1
  std::size_t cells = 0;
};

enum class PressureAt {
  points,  ///< one per cell, as in the solution
  phyxels  ///< at the corners, means of the adjacent cells, phyxelMeans(): the values that are exported
};

/// p = -tr σ / 3 of a lattice that fits a box.
/// @param away  excluded cells (or corners) next to the faces of the box, at least 1: their neighbours are read
[[nodiscard]] Roughness pressureRoughness(SolvedBody &body, PressureAt where, const Vec3 &min, const Vec3 &max,
                                          double spacing, int away);

}  // namespace validation
