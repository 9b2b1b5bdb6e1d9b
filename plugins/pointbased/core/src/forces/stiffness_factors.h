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
/// pressure) the sum is the tangent to the last digit, as far as that is positive. Other laws: a = √v R g and h = √μ a,
/// linear about the rotation R of the point, positive for any strain.
struct StiffnessFactors {
  static constexpr std::size_t kNumbers = 10;  ///< of an entry: a, m^(1/2), and h, (N/m)^(1/2)
  kernels::AlignedVector<float> numbers;  ///< [points][10][entries of the point, with zeros to a multiple of eight]
  std::vector<std::size_t> first;         ///< [points] offset of its numbers
  std::vector<float> lambda, mu;          ///< [points] Pa; may be negative

  [[nodiscard]] static std::size_t width(std::size_t entries) { return (entries + 7) / 8 * 8; }
};

/// For laminates the stiffness is that of the cell, with the share of a shear across the border instead of all of it.
/// @param gradients  [points] F of the cells
/// @param viscousScale  1/s: adds the viscous forces of velocities viscousScale · du
void findStiffnessFactors(const Constitution &constitution, const StencilSet &stencils, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
