// SPDX-License-Identifier: Apache-2.0
// Coarser and coarser lattices over the cells of a body, for multigrid. Private to the core.
#pragma once

#include <memory>

#include "pointbased/stencil.h"

namespace pointbased::detail {

/// One lattice: nodes with the pattern of its stiffness matrix, and how displacements come to it from the next coarser
/// one. Nodes are numbered slab by slab, every other slab first: no node of a slab is a neighbour of one of another slab
/// of the same half, so that those of a half can be relaxed at the same time.
struct GridLevel {
  Csr rows;                     ///< [nodes] neighbours of each, itself included, ascending
  std::vector<Index> diagonal;  ///< [nodes] entry of itself in `rows`
  std::vector<Index> slabs;     ///< first node of each slab, and the number of nodes
  std::size_t firstHalf = 0;    ///< so many slabs
  Csr parents;                  ///< [nodes] nodes of the next coarser level it follows; empty on the coarsest
  std::vector<float> parentWeights;
  Csr children;  ///< [nodes] nodes of the next finer level that follow it; empty on the finest
  std::vector<float> childWeights;

  [[nodiscard]] std::size_t nodes() const { return rows.rows(); }
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
  /// Of every pair of phyxels of an evaluation point: its entry in the rows of the finest level; those of point q begin
  /// at pairs[q], by first and second.
  std::vector<std::size_t> pairs;
  std::vector<Index> slots;
  Csr springs;  ///< [springs] phyxels that each couples, as it was built for
  std::vector<std::size_t> springPairs;
  std::vector<Index> springSlots;  ///< of their pairs, likewise
};

/// @param positions     [phyxels] m
/// @param pointCentres  [points] inside of their cells, m
/// @param spacing       m, of the largest cells
/// @param springs       phyxels that are coupled beside those of a cell
/// @return null: a cloud
[[nodiscard]] std::shared_ptr<const GridHierarchy> buildGridHierarchy(const StencilSet &stencils,
                                                                      std::span<const Vec3> positions,
                                                                      std::span<const Vec3> pointCentres,
                                                                      double spacing, const Csr &springs);

}  // namespace pointbased::detail
