// SPDX-License-Identifier: Apache-2.0
// Selects the points of a lattice that the kernels handle as cells, and arranges them in slices. Private to the core.
#pragma once

#include <optional>

#include "forces/laminate.h"
#include "pointbased/constitution.h"
#include "pointbased/stencil.h"
#include "slices.h"

namespace pointbased::kernels {

/// Numbers of one point, in the order of CellNumber, if its stencil consists of the eight corners of a cell: gradients
/// are means of those of the trilinear functions, mode rows are multiples of the products of signs. Of a point with
/// functions of second order those of its corners alone. Empty if findShape() finds no shape and no corner hangs.
[[nodiscard]] std::optional<std::array<double, kCellNumbers>> cellNumbers(const StencilSet &stencils, std::size_t q);

/// Points arranged in slices.
struct CellPlan {
  std::vector<Index> points;             ///< [slices][lanes] point of each lane; the last one of a slice is repeated
  std::vector<std::size_t> used;         ///< [slices] lanes that represent a point
  std::vector<std::uint16_t> materials;  ///< [slices]
  std::vector<Index> others;             ///< points that are not such cells, ascending
};

/// Cells with trilinear functions by material, in the order of the points, which follows a space-filling curve. Within
/// a chunk, whole cells come first, because they are all alike.
/// @param suits  per material: whether the kernels support it
/// @param laminates  points that have one are grouped
[[nodiscard]] CellPlan planCells(const StencilSet &stencils, std::size_t lanes, std::span<const std::uint8_t> suits,
                                 const ParallelFor &parallelFor = serialFor(), const detail::Laminates &laminates = {});

/// Adds points of one material to a plan.
void addSlices(std::span<const Index> points, std::uint16_t material, std::size_t lanes, CellPlan &plan);

template <class T>
[[nodiscard]] CellSlices<T> sliceCells(const StencilSet &stencils, const CellPlan &plan,
                                       const ParallelFor &parallelFor = serialFor(),
                                       const detail::Laminates &laminates = {});

template <class T>
[[nodiscard]] LawNumbers<T> lawNumbers(const Material &material, double stabilisation);

}  // namespace pointbased::kernels
