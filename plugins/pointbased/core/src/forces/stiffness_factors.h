// SPDX-License-Identifier: Apache-2.0
// Approximate stiffness of a lattice for preconditioners, as products of numbers of its entries. Private to the core.
#pragma once

#include "forces/kernels/aligned_vector.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// Contribution of an evaluation point to the stiffness between two of its entries j and l:
///
///     K_jl = λ a_j a_l^T + μ a_l a_j^T + h_j·h_l I
///
/// h: seven numbers, three of the strain and four of the modes of HourglassEnergy, each with its stiffness averaged
/// over the directions of displacement. Neo-Hooke: a = √v F^-T g; with h = √(v μ) g, λ and μ (reduced by the current
/// pressure) the sum is the tangent to the last digit, as far as that is positive. Other laws: a = √v R g and
/// h = √μ a, linear about the rotation R of the point, positive for any strain.
///
/// Points with quadratic functions have the energy of QuadraticEnergy in place of that of the modes xy, xz and yz. With
/// the principal axes p of the covariance C of their part it is a sum of three terms of the same form,
///
///     λ* b_pj b_pl^T + μ b_pl b_pj^T + μ b_pj·b_pl I,   b_p = s √(v C_pp) R Q H p,   s² = |F|²/3
///
/// b_p: scaled gradient, along p, of the strain by a displacement of the entry; H: second derivatives of its function,
/// lattice axes; Q: these axes; v: volume, m³.
struct StiffnessFactors {
  static constexpr std::size_t kNumbers = 10;               ///< of an entry: a, m^(1/2), and h, (N/m)^(1/2)
  static constexpr std::size_t kStrainGradientNumbers = 9;  ///< b of the three axes, m^(1/2); follow the ten
  /// [points][10 or 19][entries of the point, with zeros to a multiple of eight]
  kernels::AlignedVector<float> numbers;
  std::vector<std::size_t> first;  ///< [points] offset of its numbers
  std::vector<float> lambda, mu;   ///< [points] Pa; may be negative
  /// [points] λ* and μ, Pa; μ = 0: no b; empty: no point has b
  std::vector<float> strainGradientLambda, strainGradientMu;

  [[nodiscard]] static std::size_t width(std::size_t entries) { return (entries + 7) / 8 * 8; }
  [[nodiscard]] bool hasStrainGradient(std::size_t q) const {
    return !strainGradientMu.empty() && strainGradientMu[q] > 0.0F;
  }
};

/// For laminates the stiffness is that of the cell, with the share of a shear across the border instead of all of it.
/// @param gradients  [points] F of the cells
/// @param viscousScale  1/s: adds the viscous forces of velocities viscousScale · du
void findStiffnessFactors(const Constitution &constitution, const StencilSet &stencils, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
