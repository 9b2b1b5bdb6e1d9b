// SPDX-License-Identifier: Apache-2.0
// Rows of stiffness matrices from the factors of cells, and their compressed storage. Private to the core.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pointbased::kernels {

/// out += λ a c^T + μ c a^T + h·k I of one entry with all others of its cell: StiffnessFactors.
/// @param factors  [10][width]
/// @param entry  index of the row
/// @param out  [9][width]: numbers of the blocks by columns
/// @threads  any; no allocation
void addCellRow(const float *factors, std::size_t width, std::size_t entry, float lambda, float mu, float *out);
/// out += λ b_p d_p^T + μ d_p b_p^T + μ b_p·d_p I, summed over the three axes p: StiffnessFactors, strain gradient.
/// @param vectors  [3][3][width]: by axis, then by component
void addStrainGradientRow(const float *vectors, std::size_t width, std::size_t entry, float lambda, float mu,
                          float *out);

/// Rounds the blocks of a row to units of their upper bounds: SweepRows.
/// @param row  [eights][9][8]
/// @param to  [eights][8] factor of each number
/// @param back  [eights][8] units times this are added to `lost`
/// @param lost  [9] accumulated rounding errors
void roundRow(const float *row, const float *to, const float *back, std::size_t eights, std::int16_t *out, float *lost);

}  // namespace pointbased::kernels
