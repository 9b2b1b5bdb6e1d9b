// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_constraints.h"

namespace pointbased::lattice {

/// Moves the phyxels whose cells are eight full, free cells of the coarsest size by up to `jitter` edges along each
/// axis.
void jitterPhyxels(LatticeCellMap &map, std::span<const PartContent> contents, double jitter, std::uint64_t seed);

/// Means over a hexahedron, by 2×2×2 Gauss points.
struct HexahedronMeans {
  double volume = 0.0;           ///< m³
  Vec3 centroid = Vec3::Zero();  ///< m
  Vec3 variance = Vec3::Zero();  ///< m²
  std::array<double, 8> functions{};
  std::array<Vec3, 8> gradients;  ///< 1/m
};
/// @source  Flanagan and Belytschko, A uniform strain hexahedron and quadrilateral with orthogonal hourglass control,
/// 1981
[[nodiscard]] HexahedronMeans meansOf(const std::array<Vec3, 8> &corners);

}  // namespace pointbased::lattice
