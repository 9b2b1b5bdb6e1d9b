// SPDX-License-Identifier: Apache-2.0
// Statistics of least squares. Private to the core.
#pragma once

#include <cstddef>
#include <span>

namespace pointbased::detail {

/// The t with P(|T| <= t) = 0.95 of Student's distribution.
/// @param freedom  degrees of freedom, > 0
[[nodiscard]] double studentLimit(std::size_t freedom);

/// The x with P(χ² <= x) = 0.999, to about 1 %.
/// @source  Wilson and Hilferty 1931
[[nodiscard]] double largestChiSquared(std::size_t freedom);

/// Whether residuals in the order of the measurement follow each other, which independent ones do with a probability of
/// 0.001. Needs at least kFewestForOrder of them; false for fewer.
/// @source  von Neumann 1941: ratio of the mean square successive difference to the variance
[[nodiscard]] bool areCorrelated(std::span<const double> residuals);
inline constexpr std::size_t kFewestForOrder = 8;

}  // namespace pointbased::detail
