// SPDX-License-Identifier: Apache-2.0
// Strain that jumps across the border of two materials within a cell. Private to the core.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "forces/hourglass_energy.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// A point of a cell that holds two materials, as layers with a plane border and one jump of the strain across it. With
/// F_1 what the corners say at the point, F_2 their mean over the other layer, c_2 the share of that and
/// F = (1 - c_2) F_1 + c_2 F_2:
///
///     F_q = F_1 + c F y nᵀ,   y = b/√(1 + k² b²)
///     b = -Σ_i ±[2 μ_i/μ* (E_i n)_t + n (λ_i tr E_i + 2 μ_i n·E_i n)/(λ* + 2 μ*)]
///
/// E_i Green strain of F_i; c is c_2, of points of the second layer minus that; + of the first layer, - of the second;
/// * means of the moduli with the shares exchanged. For small strains that is the jump of least energy, turning
/// included; k keeps |c y| below kMostJump, so that the thinner layer is not turned over where the cell is pressed a
/// little. The linear law takes E linear and F_q = F_1 + c b nᵀ.
/// @source  Milton, The Theory of Composites, 2002, ch. 9 (laminates)
struct Laminate {
  /// 2 μ/μ*, λ/(λ* + 2 μ*), 2 μ/(λ* + 2 μ*), with the sign of the layer.
  struct Moduli {
    double shear = 0.0, trace = 0.0, across = 0.0;
  };
  Vec3 normal = Vec3::Zero();  ///< n, unit, lattice axes
  double share = 0.0;          ///< c
  double limit = 0.0;          ///< k
  Moduli own, other;
  Vec3 first = Vec3::Zero(), mixed = Vec3::Zero();  ///< of F_2, as in CellShape
  double part = 0.0;                                ///< of the point in its layer, by volume
  Index cell = 0;                                   ///< first point of the cell
  /// What of a shear across the border is this point's, for preconditioners: the other modulus over μ*.
  [[nodiscard]] double shareOfShear() const { return 0.5 * std::abs(other.shear); }
};

/// Energy of the modes of a point as a form of their strains (HourglassEnergy): xx, yy of the axes across x, across y,
/// across z, and 2 xy of these: the three 2x2 blocks of the first six (3 numbers each), 6x3, lower triangle of 3x3; J.
using ModeForm = std::array<double, 33>;

/// Laminates of the points of a body; empty where no cell has two materials.
struct Laminates {
  static constexpr Index kNone = 0xffffffffu;
  std::vector<Index> of;  ///< [points] into all, or kNone; empty: there are none
  std::vector<Laminate> all;
  /// [all] energy of the modes: their strains are shared by the layers like that of the cell, for each axis along which
  /// they vary in plane stress across it.
  std::vector<ModeForm> modes;
  std::vector<HourglassEnergy> plain;  ///< [materials] of points that are none

  [[nodiscard]] const Laminate *at(std::size_t q) const { return of.empty() || of[q] == kNone ? nullptr : &all[of[q]]; }
  [[nodiscard]] ModeForm modesAt(const StencilSet &stencils, std::size_t q) const;
};

/// Of cells with several points whose laws the kernels know, of bodies that remember nothing: forces of laminates are
/// those of the kernels alone (VectorForces). Of three materials or more those next to each other in stiffness are one
/// layer, with the mean of their moduli and one strain; the two layers are parted at the widest gap.
[[nodiscard]] Laminates findLaminates(const StencilSet &stencils, const Constitution &constitution);

/// F of the materials of the points, from those of their stencils.
/// @param gradients  [points] F, in and out
void toMaterialGradients(const Laminates &laminates, const StencilSet &stencils, const Constitution &constitution,
                         std::span<Mat3> gradients);

}  // namespace pointbased::detail
