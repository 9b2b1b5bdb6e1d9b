// SPDX-License-Identifier: Apache-2.0
// Tetrahedra for the finite element peers, from cells of a lattice: the same mesh for all of them.
#pragma once

#include <array>
#include <string>

#include "pointbased/sampling.h"

namespace peers {

using pointbased::Vec3;

struct TetraMesh {
  std::vector<Vec3> nodes;                     ///< m; fixed nodes come last
  std::size_t freeNodes = 0;                   ///< from here on fixed
  std::vector<std::array<int, 4>> tetrahedra;  ///< (b - a) x (c - a) · (d - a) > 0
  std::vector<double> volumes;                 ///< [nodes] a quarter of each adjacent tetrahedron, m³
  std::vector<double> weights;                 ///< [nodes] weights of the measured displacement; sum 1
};

[[nodiscard]] double volumeOf(const TetraMesh &mesh, const std::array<int, 4> &tetrahedron);

/// A bar along x from the origin, `layers` cells over its thickness, five tetrahedra per cell; x = 0 is fixed. The
/// weights give the mean over the far end face.
[[nodiscard]] TetraMesh meshBar(const Vec3 &size, int layers);

/// Cells of a lattice whose centre is inside, five tetrahedra each. Corners on the border are then moved onto the
/// surface as long as every adjacent tetrahedron retains a fifth of its volume. The part above `heldFrom` (z) is fixed;
/// the lattice has a plane of nodes there. The weights give the mean over the volume of the free part.
/// @param closest  the nearest point of the surface
[[nodiscard]] TetraMesh meshOrgan(const pointbased::BodyShape &shape, const std::function<Vec3(const Vec3 &)> &closest,
                                  double heldFrom, std::size_t nodes);

}  // namespace peers
