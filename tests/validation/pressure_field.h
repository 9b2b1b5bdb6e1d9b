// SPDX-License-Identifier: Apache-2.0
// The pressure of a solved body cell by cell, and how rough it is.
#pragma once

#include "solved_body.h"

namespace validation {

/// Parts of the pressure that change sign from cell to cell, against the pressure itself. Smooth fields give what their
/// third and higher derivatives leave: it falls with the square of the spacing or faster; a checkerboard stays.
struct Roughness {
  double pressure = 0.0;      ///< Pa, root mean square of p where it was looked at
  double checkerboard = 0.0;  ///< (-1)^(i+j+k): root mean square over that of p
  double planes = 0.0;        ///< the worst of (-1)^(i+j), (-1)^(i+k), (-1)^(j+k), likewise
  double lines = 0.0;         ///< the worst of (-1)^i, (-1)^j, (-1)^k, likewise
  double offLinear = 0.0;     ///< p less the linear fit of its 27 cells, likewise
  double correlation = 0.0;   ///< of p less the fit with the one pattern (-1)^(i+j+k) of the whole body, -1 … 1
  std::size_t cells = 0;
};

enum class PressureAt {
  points,  ///< one per cell, as the solution has it
  phyxels  ///< at the corners, means of the cells around, phyxelMeans(): what is handed out
};

/// p = -tr σ / 3 of a lattice that fits a box.
/// @param away  cells (or corners) from the faces of the box that are left out, at least 1: their neighbours are read
[[nodiscard]] Roughness pressureRoughness(SolvedBody &body, PressureAt where, const Vec3 &min, const Vec3 &max,
                                          double spacing, int away);

}  // namespace validation
