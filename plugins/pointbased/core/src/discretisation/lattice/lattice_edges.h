// SPDX-License-Identifier: Apache-2.0
// Functions that are quadratic along the edges of cells (LatticeOrder::quadratic). Private to the core.
#pragma once

#include "discretisation/lattice/lattice_moments.h"

namespace pointbased::lattice {

inline constexpr std::size_t kEdges = QuadraticPoints::kEdges;

/// Edge of a cell between two of its corners; numbered as in QuadraticPoints.
struct CellEdge {
  std::size_t axis, low, high;
};
[[nodiscard]] inline CellEdge edgeOfCell(std::size_t edge) {
  const std::size_t axis = edge / 4, low = (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
  return {axis, low, low | std::size_t{1} << axis};
}

/// Functions of the twelve edges, E = (1 - 4 ξ²)(½ ± η)(½ ± ζ) with ξ along the edge, and their gradients, 1/edge.
struct EdgeFunctions {
  std::array<double, kEdges> values{};
  std::array<Vec3, kEdges> gradients;
};
/// @param place  in edges from the centre of the cell; outside of the cell they continue linearly
[[nodiscard]] EdgeFunctions edgeFunctionsAt(const Vec3 &place);

using SecondDerivatives = std::array<double, 6>;  ///< xx, yy, zz, xy, xz, yz
/// Means over a part of a cell, in units of its edge.
struct EdgeMeans {
  EdgeFunctions functions;
  std::array<SecondDerivatives, kEdges> second{};
  std::array<Vec3, 8> ofCorners;  ///< xy, xz, yz of the trilinear functions
};
[[nodiscard]] EdgeMeans edgeMeansOf(const Moments &moments);

/// The edges with functions of second order. With u_k in a row of corners, the coefficient of the function between k
/// and k + 1 is that of the cubic polynomial through four of them,
///
///     b = (-u_{k-1} + u_k + u_{k+1} - u_{k+2})/16,
///
/// at the end of a row that of the parabola through three, (-u_k + 2 u_{k+1} - u_{k+2})/8, and 0 where the row has only
/// these two. All cells around an edge have the same coefficient, so that the motion is continuous; b = 0 for affine
/// motions.
///
/// Phyxels with less than a fiftieth of the largest volume among the four nearest to the edge are left out: b is that
/// of the nearest parabola through three others in succession, or 0. Otherwise the functions of edges would give a
/// phyxel with little mass the stiffness of whole cells, which shortens explicit steps to a quarter.
struct QuadraticEdges {
  std::vector<std::array<Index, kEdges>> ofParts;  ///< row, or kNone; empty: no edges
  Csr phyxels;
  std::vector<double> weights;  ///< per entry of `phyxels`

  [[nodiscard]] bool any() const { return !ofParts.empty(); }
  /// Calls visit(edge, row) for the edges of a part.
  template <class Visit>
  void forPart(Index part, const Visit &visit) const {
    if (ofParts.empty()) return;
    for (std::size_t e = 0; e < kEdges; ++e)
      if (ofParts[part][e] != kNone) visit(e, ofParts[part][e]);
  }
};

/// Finds the edges of the parts with `wanted`. Excluded are edges of parts with `excluded`, edges between cells of two
/// sizes, and rows with a gap of the body.
/// @param taking  [parts] with an evaluation point: only their edges continue rows
/// @param volumes  [phyxels] free material attributed to each, in volumes of a cell
[[nodiscard]] QuadraticEdges findQuadraticEdges(const CellSet &set, std::span<const CutCellFragment> parts,
                                                const NodeTable &corners, std::span<const std::uint8_t> taking,
                                                std::span<const std::uint8_t> wanted,
                                                std::span<const std::uint8_t> excluded,
                                                std::span<const double> volumes);

}  // namespace pointbased::lattice
