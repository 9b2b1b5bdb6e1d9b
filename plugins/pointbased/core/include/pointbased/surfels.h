// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// Points of the surface (or any material points) and the phyxels that move them. Const once bound.
struct SurfelBinding {
  std::vector<Vec3> positions;  ///< reference, m, in the frame of the phyxels
  std::vector<Vec3> normals;    ///< unit; empty: points without normals
  Csr phyxels;                  ///< per surfel
  std::vector<double> weights;  ///< per entry, positive, sum 1 per surfel

  [[nodiscard]] std::size_t count() const { return positions.size(); }
};

/// So many phyxels move a surfel: enough for a smooth skin, few enough for a cheap update.
inline constexpr std::size_t kPhyxelsPerSurfel = 16;

/// Binds every point to its nearest phyxels, wherever it lies: a surfel outside every support follows the nearest ones.
[[nodiscard]] SurfelBinding bindSurfels(std::span<const Vec3> positions, std::span<const Vec3> normals,
                                        std::span<const Vec3> phyxelPositions, const ParallelFor &parallelFor);

/// x_s = X_s + Σ_j w_sj (u_j + (F_j - I)(X_s - X_j)),   n_s = cof(Σ_j w_sj F_j) N_s, normalised.
///
/// @param phyxelPositions  [phyxels] X, m
/// @param gradients        [phyxels] F at the phyxels
/// @param positions        [surfels] out, m
/// @param normals          [surfels] out, or empty
/// @source Müller et al. 2004, the displacement of surfels; normals by Nanson's formula
void updateSurfels(const SurfelBinding &binding, std::span<const Vec3> phyxelPositions, std::span<const Vec3> displacements,
                   std::span<const Mat3> gradients, std::span<Vec3> positions, std::span<Vec3> normals,
                   const ParallelFor &parallelFor);

}  // namespace pointbased
