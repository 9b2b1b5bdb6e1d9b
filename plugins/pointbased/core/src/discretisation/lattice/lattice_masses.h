// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_constraints.h"

namespace pointbased::lattice {

/// Volumes represented by each phyxel, m³.
struct PhyxelVolumes {
  std::vector<double> inertial;  ///< > 0; multiplied by the density, the mass
  std::vector<double> weights;   ///< ∫N_j: share of a uniform load on the material; same sum
  std::vector<double> carried;   ///< part of `inertial` that moves with a support; empty: nothing is held
  std::vector<double> held;      ///< part of `weights` that moves with a support; empty: nothing is held
};

/// Shares the volume of every part among its corners, by the means of N_j for loads, which preserves volume and centre.
///
/// Masses need the second moments as well. Corners at x₀ and x₁ have larger ones than the material between them, by
///
///     e = ∫_part (x − x₀)(x₁ − x) dV      along each axis; v h²/6 for a whole cell
///
/// Second differences −e/(2h²) (1, −2, 1) over three corners in a row subtract that and preserve volume and
/// centre. Inside the body neighbours cancel. At its ends the weights become those of an end-corrected quadrature
/// (3/8, 9/8, 9/8, 3/8 for three cells across: Simpson's three-eighths rule). Without them a bar of n cells has 1 +
/// 2/n² times its inertia about its axis. If a phyxel would have too little mass for a reasonable explicit step, the
/// correction is partial or has the opposite sign, and slivers are distributed more evenly. MomentErrors reduces the
/// errors of the moments that both cause, in bodies with cells of second order. A body one cell thick has no three
/// corners in a row across.
///
/// Next to held material, the moving mass is that of the free material, but never less than its stiffness requires: the
/// support then moves less (`carried`), and the sum is preserved.
/// @param parallelFor  used to check for cancellation only
/// @source  Gregory's end corrections (Davis and Rabinowitz, Methods of Numerical Integration, 2.9); for cut cells: own
[[nodiscard]] PhyxelVolumes shareVolumes(const LatticeCellMap &map, std::span<const PartContent> contents,
                                         const ParallelFor &parallelFor);

/// Adds the integrals of the functions of edges (LatticeOrder::quadratic) to the shares of a uniform load. Volume and
/// centre do not change.
void addEdgeWeights(const LatticeCellMap &map, std::span<const PartContent> contents, PhyxelVolumes &volumes);

}  // namespace pointbased::lattice
