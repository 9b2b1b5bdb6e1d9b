// SPDX-License-Identifier: Apache-2.0
// Tetrahedra for the finite element peers, from cells of a lattice: the same for all of them.
#pragma once

#include <array>
#include <string>

#include "pointbased/sampling.h"

namespace peers {

using pointbased::Vec3;

struct TetraMesh {
  std::vector<Vec3> nodes;                     ///< m; those that are held come last
  std::size_t freeNodes = 0;                   ///< held: from here on
  std::vector<std::array<int, 4>> tetrahedra;  ///< (b - a) x (c - a) · (d - a) > 0
  std::vector<double> volumes;                 ///< [nodes] a quarter of each tetrahedron around, m³
  std::vector<double> weights;                 ///< [nodes] what the measured displacement is the mean with; sum 1
};

[[nodiscard]] double volumeOf(const TetraMesh &mesh, const std::array<int, 4> &tetrahedron);

/// A bar along x from the origin, `layers` cells over its thickness, five tetrahedra per cell; x = 0 is held. The
/// weights give the mean over the far end face.
[[nodiscard]] TetraMesh meshBar(const Vec3 &size, int layers);

/// Cells of a lattice whose middle lies inside, five tetrahedra each; corners on the border are then moved onto the
/// surface as far as every tetrahedron around them keeps a fifth of its volume. What lies above `heldFrom` (z) is held;
/// the lattice has a plane of nodes there. The weights give the mean over the volume of the free part.
/// @param closest  the nearest point of the surface
[[nodiscard]] TetraMesh meshOrgan(const pointbased::BodyShape &shape, const std::function<Vec3(const Vec3 &)> &closest,
                                  double heldFrom, std::size_t nodes);

}  // namespace peers
