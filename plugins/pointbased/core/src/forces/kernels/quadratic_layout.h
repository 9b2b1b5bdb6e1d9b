// SPDX-License-Identifier: Apache-2.0
// Arranges the points of a lattice with functions of second order in slices. Private to the core.
#pragma once

#include "cell_layout.h"
#include "quadratic_slices.h"

namespace pointbased::kernels {

/// Moves the points with functions of second order from `others` to a plan of their own, by material.
/// @param suits  per material: whether the kernels support it
[[nodiscard]] CellPlan planQuadraticCells(const StencilSet &stencils, std::size_t lanes,
                                          std::span<const std::uint8_t> suits, std::vector<Index> &others);

template <class T>
[[nodiscard]] QuadraticSlices<T> sliceQuadraticCells(const StencilSet &stencils, const CellPlan &plan,
                                                     const ParallelFor &parallelFor = serialFor());

}  // namespace pointbased::kernels
