// SPDX-License-Identifier: Apache-2.0
// Strain that jumps across the border of two materials within a cell. Private to the core.
#pragma once

#include <vector>

#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// A point of a cell that holds two materials, as layers with a plane border. The strain F of the cell is their mean,
/// and that across the border is shared so that both press on each other alike (a laminate of rank one):
///
///     F_q = F (1 + c y nᵀ),   y = b/√(1 + k² b²),   b = -[2 Δμ/μ* (E n)_t + n (Δλ tr E + 2 Δμ n·E n)/(λ* + 2 μ*)]
///
/// E Green strain of F; c the share of the other layer, of points of the second one minus that of the first; Δ the
/// difference of the moduli, * their means with the shares exchanged. For small strains this is the solution, turning
/// included; k keeps |c y| below kMostJump, so that the thinner layer is not turned over where the cell is pressed a
/// little. The linear law takes E linear and F_q = F + c b nᵀ.
/// @source  Milton, The Theory of Composites, 2002, ch. 9 (laminates)
struct Laminate {
  Vec3 normal = Vec3::Zero();  ///< n, unit, lattice axes
  double share = 0.0;          ///< c
  double shear = 0.0;          ///< 2 Δμ/μ*
  double trace = 0.0;          ///< Δλ/(λ* + 2 μ*)
  double across = 0.0;         ///< 2 Δμ/(λ* + 2 μ*)
  double limit = 0.0;          ///< k
  /// What of a shear across the border is this point's, for preconditioners: the other modulus over μ*.
  [[nodiscard]] double shareOfShear() const { return 1.0 - 0.5 * share * shear; }
};

/// Laminates of the points of a body; empty where no cell has two materials.
struct Laminates {
  static constexpr Index kNone = 0xffffffffu;
  std::vector<Index> of;  ///< [points] into all, or kNone; empty: there are none
  std::vector<Laminate> all;

  [[nodiscard]] const Laminate *at(std::size_t q) const { return of.empty() || of[q] == kNone ? nullptr : &all[of[q]]; }
};

/// Of cells with several points whose laws the kernels know, of bodies that remember nothing: forces of laminates are
/// those of the kernels alone (VectorForces). Of three materials or more those next to each other in stiffness are one
/// layer, with the mean of their moduli and one strain; the two layers are parted at the widest gap.
[[nodiscard]] Laminates findLaminates(const StencilSet &stencils, const Constitution &constitution);

/// F of the material of a point, from that of its cell.
/// @param axes  StencilSet::axes
[[nodiscard]] Mat3 materialGradient(const Laminate &laminate, const Mat3 &axes, const Mat3 &F, bool isLinear);

}  // namespace pointbased::detail
