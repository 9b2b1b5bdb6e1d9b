// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "discretisation/lattice/lattice_grid.h"

namespace pointbased::lattice {

/// A connected part of (cell ∩ body).
struct CutCellFragment {
  std::uint64_t samples = 0;     ///< bit per sample that belongs to it
  double share = 0.0;            ///< of the cell
  std::array<Index, 8> nodes{};  ///< corners: rows of NodeTable
  Index cell = 0;
  bool kept = true;  ///< false: too small to be represented
};

/// The body continues from part a through face `face` (2 axis + (1 if upwards)) of its cell into part b, whose cell is
/// of the same size (face upwards) or twice as large.
struct FragmentLink {
  Index a = 0, b = 0;
  std::uint8_t face = 0;
};

struct PartSet {
  std::vector<CutCellFragment> parts;  ///< by cell
  std::vector<Index> first;            ///< [cells + 1] parts of a cell
  std::vector<FragmentLink> links;
  std::size_t components = 0;  ///< of those kept
};

/// Samples of a cell are connected through faces of their small cells. BodyShape::crosses decides between two samples
/// inside that are nearer to the surface than to each other. A sample whose centre is outside belongs to the sample
/// inside that is found by descending the distance. It connects only what `crosses` does not separate, so that thin
/// slabs do not fall apart and gaps thinner than the distance of samples are not bridged. Without `crosses`, gaps of
/// half an edge separate.
[[nodiscard]] PartSet findParts(const CellSet &set, const BodyShape &shape, const ParallelFor &parallelFor);

/// Rows of every (part, corner): its phyxels with their weights. A row has one phyxel of weight 1, or those of the edge
/// or face of the larger cell on which the corner hangs. Without hanging corners rows are phyxels, and after compact()
/// only phyxels remain.
struct NodeTable {
  std::vector<std::uint32_t> offsets{0};  ///< empty: row i is phyxel i
  std::vector<Index> phyxels;
  std::vector<double> weights;
  std::vector<Vec3> positions;  ///< [phyxels] lattice axes, m, sorted along a Z curve
  /// Calls visit(phyxel, weight) for the entries of a row.
  template <class Visit>
  void visit(Index row, const Visit &visit) const {
    if (offsets.empty()) return visit(row, 1.0);
    for (std::uint32_t e = offsets[row]; e < offsets[row + 1]; ++e) visit(phyxels[e], weights[e]);
  }
  /// Frees positions, and rows that are phyxels.
  void compact();
};

/// Joins the corners of linked parts and numbers the phyxels; fills CutCellFragment::nodes.
[[nodiscard]] NodeTable joinCorners(const CellSet &set, PartSet &parts, const ParallelFor &parallelFor);

}  // namespace pointbased::lattice
