// SPDX-License-Identifier: Apache-2.0
// The stiffness of a lattice, near enough for preconditioners, as products of numbers of its entries. Private to the
// core.
#pragma once

#include "forces/kernels/aligned_vector.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"

namespace pointbased::detail {

/// What an evaluation point adds to the stiffness between two of its entries j and l:
///
///     K_jl = λ a_j a_l^T + μ (a_l a_j^T + a_j·a_l I) + h_j·h_l I
///
/// a = √v R g: an isotropic material, linear about the rotation R of the point, so that the sum is positive whatever
/// the strain. h: the modes of HourglassEnergy, each with the mean of its three stiffnesses.
struct StiffnessFactors {
  static constexpr std::size_t kNumbers = 7;  ///< of an entry: a, m^(1/2), and h, (N/m)^(1/2)
  kernels::AlignedVector<float> numbers;      ///< [points][7][entries of the point, with zeros to a multiple of eight]
  std::vector<std::size_t> first;             ///< [points] of its numbers
  std::vector<float> lambda, mu;              ///< [points] Pa

  [[nodiscard]] static std::size_t width(std::size_t entries) { return (entries + 7) / 8 * 8; }
};

/// @param gradients     [points] F
/// @param viscousScale  1/s: adds the viscous forces of velocities viscousScale · du
void findStiffnessFactors(const Constitution &constitution, const StencilSet &stencils, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
