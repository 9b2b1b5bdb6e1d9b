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
/// F_1, F_2 the means over the layers of what the corners say, c_1, c_2 their shares and F = c_1 F_1 + c_2 F_2:
///
///     F_q += c F y nᵀ,   y = b/√(1 + k² b²)
///     b = -Σ_k ±[2 μ_k/μ* (E_k n)_t + n (λ_k tr E_k + 2 μ_k n·E_k n)/(λ* + 2 μ*)]
///
/// E_k Green strain of F_k; c the share of the other layer, of points of the second one minus that of the first;
/// + of the first; * means of the moduli with the shares exchanged. For small strains that is the jump of least energy,
/// turning included; k keeps |c y| below kMostJump, so that the thinner layer is not turned over where the cell is
/// pressed a little. The linear law takes E linear and F_q += c b nᵀ.
/// @source  Milton, The Theory of Composites, 2002, ch. 9 (laminates)
struct Laminate {
  /// 2 μ/μ*, λ/(λ* + 2 μ*), 2 μ/(λ* + 2 μ*), with the sign of the layer; mean gradients as in CellShape.
  struct Layer {
    double share = 0.0, shear = 0.0, trace = 0.0, across = 0.0;
    Vec3 first = Vec3::Zero(), mixed = Vec3::Zero();
  };
  Vec3 normal = Vec3::Zero();  ///< n, unit, lattice axes
  double share = 0.0;          ///< c
  double limit = 0.0;          ///< k
  double part = 0.0;           ///< of the point in its layer
  Index cell = 0;              ///< first point of the cell
  std::array<Layer, 2> layers;
  /// What of a shear across the border is this point's, for preconditioners: the other modulus over μ*.
  [[nodiscard]] double shareOfShear() const { return 0.5 * std::abs(layers[share > 0.0 ? 1 : 0].shear); }
};

/// dU/dB = K B of the modes xy, xz, yz, B as in HourglassEnergy, column after column: the lower triangle, row by row.
using ModeMatrix = std::array<double, 45>;

/// Laminates of the points of a body; empty where no cell has two materials.
struct Laminates {
  static constexpr Index kNone = 0xffffffffu;
  std::vector<Index> of;  ///< [points] into all, or kNone; empty: there are none
  std::vector<Laminate> all;
  /// [all] energy of the modes: their strains are shared by the layers like that of the cell, for each axis along which
  /// they vary in plane stress across it.
  std::vector<ModeMatrix> modes;
  std::vector<HourglassEnergy> plain;  ///< [materials] of points that are none

  [[nodiscard]] const Laminate *at(std::size_t q) const { return of.empty() || of[q] == kNone ? nullptr : &all[of[q]]; }
  [[nodiscard]] ModeMatrix modesAt(const StencilSet &stencils, std::size_t q) const;
};

enum class LaminateModes : bool { without, with };

/// Of cells with several points whose laws the kernels know, of bodies that remember nothing: forces of laminates are
/// those of the kernels alone (VectorForces). Of three materials or more those next to each other in stiffness are one
/// layer, with the mean of their moduli and one strain; the two layers are parted at the widest gap.
[[nodiscard]] Laminates findLaminates(const StencilSet &stencils, const Constitution &constitution,
                                      LaminateModes modes);

/// F of the materials of the points, from those of their stencils.
/// @param gradients  [points] F, in and out
void toMaterialGradients(const Laminates &laminates, const StencilSet &stencils, const Constitution &constitution,
                         std::span<Mat3> gradients);

}  // namespace pointbased::detail
