// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pointbased/body.h"

namespace pointbased {

/// Scratch storage of the stress functions.
struct StressScratch {
  std::vector<Mat3> firstPiola;  ///< [points] v P, Pa m³
  std::vector<double> ratios;    ///< [points]
};

/// Stress of every evaluation point at gradients(), each by the law of its own material, including flow and relaxation,
/// without the viscous part and the stabilisation of modes. Zero where a point is inverted (J <= 0).
///
///     second Piola-Kirchhoff: S = F^-1 P,   Cauchy: σ = P F^T / J;   with the linear law both are P
///
/// @param out  [points] Pa, symmetric
/// @threads one at a time per scratch; bitwise identical for any number of threads behind parallelFor
void secondPiolaStresses(const Body &body, std::span<Mat3> out, StressScratch &scratch, const ParallelFor &parallelFor);
void cauchyStresses(const Body &body, std::span<Mat3> out, StressScratch &scratch, const ParallelFor &parallelFor);

/// sqrt(3/2 s : s), with s the deviator of a symmetric stress: the equivalent uniaxial stress.
[[nodiscard]] double vonMises(const Mat3 &stress);

/// The evaluation points as points of the body, at the centroids of their material, carried by the phyxels of their own
/// stencils.
[[nodiscard]] Interpolation bindPoints(const RestState &rest);

/// Σ φ a of any field of the phyxels, clamped to the range of the surrounding phyxels, because weights may be negative.
void interpolateScalars(const Interpolation &binding, std::span<const double> field, std::span<double> out,
                        const ParallelFor &parallelFor);

}  // namespace pointbased
