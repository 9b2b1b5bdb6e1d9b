// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace c3de::geometry {

/// Diagonal of the bounding box. No patient and no table is 10 m long, while an organ of 200 mm read in metres would be
/// 200 m: such a mesh is refused. From 2 m on it is larger than a person and causes a warning.
inline constexpr double kMaxDiagonal_mm = 10'000.0;
inline constexpr double kWarnDiagonal_mm = 2'000.0;
inline constexpr double kSmallDiagonal_mm = 1.0;

/// Thinner than a billionth of its size: nothing that can be filled, only rounding.
[[nodiscard]] inline bool isFlat(double volume_mm3, double diagonal_mm) {
  return !(std::abs(volume_mm3) > 1e-9 * diagonal_mm * diagonal_mm * diagonal_mm);
}

}  // namespace c3de::geometry
