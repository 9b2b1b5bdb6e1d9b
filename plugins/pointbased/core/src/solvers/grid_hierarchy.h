// SPDX-License-Identifier: Apache-2.0
// Hierarchy of coarser lattices over the cells of a body, for multigrid. Private to the core.
#pragma once

#include <cstdint>
#include <memory>

#include "pointbased/stencil.h"
#include "pointbased/stop_request.h"

namespace pointbased::detail {

/// One lattice: nodes with the pattern of its stiffness matrix, its cells, and the interpolation of displacements from
/// the next coarser lattice. Nodes are numbered slab by slab, every other slab first. No node of a slab is a neighbour
/// of a node in another slab of the same half, so the slabs of a half can be relaxed concurrently. Within a slab,
/// independent nodes are consecutive.
struct GridLevel {
  Csr rows;                     ///< [nodes] neighbours of each, including itself, ascending
  std::vector<Index> diagonal;  ///< [nodes] its own entry in `rows`
  std::vector<Index> slabs;     ///< first node of each slab, and the number of nodes
  std::size_t firstHalf = 0;    ///< number of slabs in the first half
  Csr parents;                  ///< [nodes] nodes of the next coarser level that it follows; empty on the coarsest
  std::vector<float> parentWeights;
  Csr children;  ///< [nodes] nodes of the next finer level that follow it; empty on the finest
  std::vector<float> childWeights;

  /// Neighbours in groups of eight, those before a node and those after it: SweepRows.
  std::vector<Index> eights, columns;

  /// The matrix is the sum of those of cells and springs, so a coarser matrix is the sum of theirs (of trilinear ones).
  Csr cells;  ///< nodes of each cell, then of each spring; on coarser levels those they follow
  /// The same with functions of second order, whose rows are wider than a cell; empty: `cells`. Only the matrix of the
  /// finest level has them.
  Csr wideCells;
  Csr cellsOf;                     ///< [nodes] entries of rowCells()
  std::vector<Index> cellOfEntry;  ///< [entries of rowCells()]
  std::vector<Index> firstEntry;   ///< [nodes] first entry of `cells` with the node; their number if none has it
  /// [nodes] first of `slots`: for every entry of `cellsOf`, the slots of the nodes of its cell in the row of the node.
  std::vector<std::size_t> firstSlot;
  std::vector<std::uint16_t> slots;   ///< slotOf()
  Csr finer;                          ///< [cells] cells of the next finer level that form it; empty on the finest
  std::vector<std::uint16_t> places;  ///< for every parent of the node of an entry: its position in the coarser cell
  std::vector<Index> firstPlace;      ///< [entries]

  [[nodiscard]] std::size_t nodes() const { return rows.rows(); }
  /// Cells whose matrices are added in the rows of this level.
  [[nodiscard]] const Csr &rowCells() const { return wideCells.indices.empty() ? cells : wideCells; }
  /// Offset of the numbers of the k-th column in a row that is being summed, [1 + eights][9][8]; the block of the node
  /// itself is at 0.
  [[nodiscard]] static std::size_t slotOf(std::size_t k) { return 72 * (1 + k / 8) + k % 8; }
};

/// The levels, starting with the phyxels. A coarse cell is two cells wide. Parts of the body in it that share no phyxel
/// remain separate and have separate corners; neighbours that share a phyxel share corners. Nothing is coupled across a
/// gap on any level. Cells larger than those of a level are unchanged on it.
/// @source  Dick, Georgii, Westermann, A hexahedral multigrid approach for simulating cuts in deformable objects, IEEE
/// TVCG 17, 2011 (cells of connected components)
struct GridHierarchy {
  std::vector<GridLevel> levels;
  std::vector<Index> order;   ///< [nodes of the finest level] phyxel
  std::vector<Index> number;  ///< [phyxels] node of the finest level
  Csr springs;                ///< [springs] phyxels coupled by each, as at construction
  /// The points with trilinear functions, for coarser levels. Null: all points have these.
  std::unique_ptr<const StencilSet> trilinear;
};

/// @param positions  [phyxels] m
/// @param pointCentres  [points] inside of their cells, m
/// @param spacing  of the largest cells, m
/// @param springs  phyxels coupled in addition to those of a cell
/// @param stop  null, or a request that ends construction with Stopped
/// @return null: a cloud
[[nodiscard]] std::shared_ptr<const GridHierarchy> buildGridHierarchy(const StencilSet &stencils,
                                                                      std::span<const Vec3> positions,
                                                                      std::span<const Vec3> pointCentres,
                                                                      double spacing, const Csr &springs,
                                                                      const StopRequest *stop);

}  // namespace pointbased::detail
