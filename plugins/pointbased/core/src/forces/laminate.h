// SPDX-License-Identifier: Apache-2.0
// Strain jump across the border of two materials within a cell. Private to the core.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "forces/hourglass_energy.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// A point of a cell that contains two materials, modelled as layers with a plane border and one jump of the strain
/// across it. With F_1 from the corners at the point, F_2 its mean over the other layer, c_2 the share of that layer
/// and F = (1 - c_2) F_1 + c_2 F_2:
///
///     F_q = F_1 + c F y nᵀ,   y = b/√(1 + k² b²)
///     b = -Σ_i ±[2 μ_i/μ* (E_i n)_t + n (λ_i tr E_i + 2 μ_i n·E_i n)/(λ* + 2 μ*)]
///
/// E_i is the Green strain of F_i; c is c_2, and -c_2 for points of the second layer; + for the first layer, - for the
/// second; * means of the moduli with the shares exchanged. For small strains this is the jump of least energy,
/// including rotation. k keeps |c y| below kMaxJump, so that the thinner layer is not inverted by slight compression
/// of the cell. The linear law uses the linear strain and F_q = F_1 + c b nᵀ.
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
  /// Share of this point in a shear across the border, for preconditioners: the other modulus over μ*.
  [[nodiscard]] double shareOfShear() const { return 0.5 * std::abs(other.shear); }
};

/// Energy of the modes of a point as a quadratic form of their strains (HourglassEnergy): xx, yy in the planes
/// perpendicular to x, y and z, and 2 xy of these. Stored are the three 2x2 blocks of the first six (3 numbers each),
/// 6x3, and the lower triangle of 3x3; J.
using ModeForm = std::array<double, 33>;

/// Laminates of the points of a body; empty where no cell has two materials.
struct Laminates {
  static constexpr Index kNone = 0xffffffffu;
  std::vector<Index> of;  ///< [points] index into all, or kNone; empty: there are none
  std::vector<Laminate> all;
  /// [all] energy of the modes: the layers share the strains of the modes as they share those of the cell, for each
  /// axis along which they vary, in plane stress perpendicular to it.
  std::vector<ModeForm> modes;
  std::vector<HourglassEnergy> plain;  ///< [materials] of points without laminate

  [[nodiscard]] const Laminate *at(std::size_t q) const { return of.empty() || of[q] == kNone ? nullptr : &all[of[q]]; }
  [[nodiscard]] ModeForm modesAt(const StencilSet &stencils, std::size_t q) const;
};

/// Laminates of cells with several points whose laws the kernels support, for bodies without history: only the kernels
/// (VectorForces) compute their forces. Of three or more materials, those adjacent in stiffness form one layer, with
/// the mean of their moduli and one strain. The two layers are separated at the widest gap.
[[nodiscard]] Laminates findLaminates(const StencilSet &stencils, const Constitution &constitution);

/// Converts F of the stencils of points to F of their materials.
/// @param gradients  [points] F, in and out
void toMaterialGradients(const Laminates &laminates, const StencilSet &stencils, const Constitution &constitution,
                         std::span<Mat3> gradients);

}  // namespace pointbased::detail
