// SPDX-License-Identifier: Apache-2.0
// Which points of a lattice are cells that the kernels take, and their slices. Private to the core.
#pragma once

#include <optional>

#include "forces/laminate.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"
#include "slices.h"

namespace pointbased::kernels {

/// The numbers of one point, in the order of CellNumber, where its stencil is that of eight corners of a cell:
/// gradients are means of those of the trilinear functions, mode rows are multiples of the products of signs. Nothing
/// where findShape() finds none and no corner hangs.
[[nodiscard]] std::optional<std::array<double, kCellNumbers>> cellNumbers(const StencilSet &stencils, std::size_t q);

/// Points by slices.
struct CellPlan {
  std::vector<Index> points;             ///< [slices][lanes] point of each lane; the last one of a slice is repeated
  std::vector<std::size_t> used;         ///< [slices] lanes that stand for a point
  std::vector<std::uint16_t> materials;  ///< [slices]
  std::vector<Index> others;             ///< points that are no cells, ascending
};

/// Cells in the order of the points, which follows a space-filling curve, by material; within a chunk whole cells
/// first, which are all alike.
/// @param suits      per material: whether the kernels know its response
/// @param laminates  points that have one are taken together
[[nodiscard]] CellPlan planCells(const StencilSet &stencils, std::size_t lanes, std::span<const std::uint8_t> suits,
                                 const ParallelFor &parallelFor = serialFor(), const detail::Laminates &laminates = {});

template <class T>
[[nodiscard]] CellSlices<T> sliceCells(const StencilSet &stencils, const CellPlan &plan,
                                       const ParallelFor &parallelFor = serialFor(),
                                       const detail::Laminates &laminates = {});

template <class T>
[[nodiscard]] LawNumbers<T> lawNumbers(const Material &material, double stabilisation);

}  // namespace pointbased::kernels
