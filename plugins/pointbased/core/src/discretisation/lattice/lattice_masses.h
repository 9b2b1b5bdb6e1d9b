// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_constraints.h"

namespace pointbased::lattice {

/// What of the body each phyxel stands for, m³.
struct PhyxelVolumes {
  std::vector<double> inertial;  ///< > 0; density times it is the mass
  std::vector<double> weights;   ///< ∫N_j: what a uniform load on the material gives each; same sum
  std::vector<double> carried;   ///< part of `inertial` that moves with a support; empty: nothing is held
  std::vector<double> held;      ///< part of `weights` that moves with a support; empty: nothing is held
};

/// Shares the volume of every part among its corners, by the means of N_j for loads, which keeps volume and centre.
///
/// Masses need the second moments too: corners at x₀ and x₁ have more of them than the material between them, by
///
///     e = ∫_part (x − x₀)(x₁ − x) dV      along each axis; v h²/6 for a whole cell
///
/// Second differences −e/(2h²) (1, −2, 1) over three corners in a row take that away and leave volume and centre as
/// they are. Inside the body neighbours cancel; at its ends the weights become those of an end-corrected quadrature
/// (3/8, 9/8, 9/8, 3/8 for three cells across: Simpson's three-eighths rule). Without them a bar of n cells has 1 +
/// 2/n² times its inertia about its axis. Where a phyxel would be left with too little for a reasonable explicit step,
/// the correction is partial or goes the other way; a body one cell thick has no three corners in a row across.
///
/// What moves beside held material is the free material's, but never less than its stiffness asks for: the support then
/// carries less (`carried`), and the whole stays.
/// @param parallelFor  asked whether it is still wanted; runs nothing
/// @source  Gregory's end corrections (Davis and Rabinowitz, Methods of Numerical Integration, 2.9); for cut cells: own
[[nodiscard]] PhyxelVolumes shareVolumes(const LatticeCellMap &map, std::span<const PartContent> contents,
                                         const ParallelFor &parallelFor);

}  // namespace pointbased::lattice
