// SPDX-License-Identifier: Apache-2.0
// Coarser and coarser lattices over the cells of a body, for multigrid. Private to the core.
#pragma once

#include <cstdint>
#include <memory>

#include "pointbased/stencil.h"
#include "pointbased/stop_request.h"

namespace pointbased::detail {

/// One lattice: nodes with the pattern of its stiffness matrix, its cells, and how displacements come to it from the
/// next coarser one. Nodes are numbered slab by slab, every other slab first: no node of a slab is a neighbour of one
/// of another slab of the same half, so that those of a half can be relaxed at the same time. In a slab those follow
/// one another that need not wait for one another.
struct GridLevel {
  Csr rows;                     ///< [nodes] neighbours of each, itself included, ascending
  std::vector<Index> diagonal;  ///< [nodes] entry of itself in `rows`
  std::vector<Index> slabs;     ///< first node of each slab, and the number of nodes
  std::size_t firstHalf = 0;    ///< so many slabs
  Csr parents;                  ///< [nodes] nodes of the next coarser level it follows; empty on the coarsest
  std::vector<float> parentWeights;
  Csr children;  ///< [nodes] nodes of the next finer level that follow it; empty on the finest
  std::vector<float> childWeights;

  /// Neighbours by eights, those before a node and those after it: SweepRows.
  std::vector<Index> eights, columns;

  /// The matrix is the sum of those of cells and springs, so a coarser one is the sum of theirs.
  Csr cells;                       ///< nodes of each cell, then of each spring; on coarser levels those they follow
  Csr cellsOf;                     ///< [nodes] entries of `cells`
  std::vector<Index> cellOfEntry;  ///< [entries]
  /// [nodes] first of `slots`: of every entry of `cellsOf`, in the row of the node, those of the nodes of its cell.
  std::vector<std::size_t> firstSlot;
  std::vector<std::uint16_t> slots;   ///< slotOf()
  Csr finer;                          ///< [cells] cells of the next finer level that make it; empty on the finest
  std::vector<std::uint16_t> places;  ///< of every parent of the node of an entry: in the coarser cell
  std::vector<Index> firstPlace;      ///< [entries]

  [[nodiscard]] std::size_t nodes() const { return rows.rows(); }
  /// Where in a row that is being summed, [1 + eights][9][8], the numbers of its k-th column are; the block of the
  /// node itself begins at 0.
  [[nodiscard]] static std::size_t slotOf(std::size_t k) { return 72 * (1 + k / 8) + k % 8; }
};

/// The levels, from the phyxels on. A coarse cell is two cells wide; parts of the body in it that share no phyxel stay
/// apart and have corners of their own, and corners are shared by neighbours that share a phyxel: nothing couples
/// across a gap on any level. Cells that are larger than a level's stay as they are on it.
/// @source  Dick, Georgii, Westermann, A hexahedral multigrid approach for simulating cuts in deformable objects, IEEE
///          TVCG 17, 2011 (cells of connected components)
struct GridHierarchy {
  std::vector<GridLevel> levels;
  std::vector<Index> order;   ///< [nodes of the finest level] phyxel
  std::vector<Index> number;  ///< [phyxels] node of the finest level
  Csr springs;                ///< [springs] phyxels that each couples, as it was built for
};

/// @param positions     [phyxels] m
/// @param pointCentres  [points] inside of their cells, m
/// @param spacing       m, of the largest cells
/// @param springs       phyxels that are coupled beside those of a cell
/// @param stop          null, or what ends it half way, with Stopped
/// @return null: a cloud
[[nodiscard]] std::shared_ptr<const GridHierarchy> buildGridHierarchy(const StencilSet &stencils,
                                                                      std::span<const Vec3> positions,
                                                                      std::span<const Vec3> pointCentres,
                                                                      double spacing, const Csr &springs,
                                                                      const StopRequest *stop);

}  // namespace pointbased::detail
