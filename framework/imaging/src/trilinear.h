// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "c3de/core/vec.h"

namespace c3de::imaging {

/// The cell along one axis that contains a position in [0, size - 1]. The last point belongs to the cell before it, or
/// is a cell of its own in a grid of one point.
[[nodiscard]] inline std::size_t cellOf(double at, std::size_t size) {
  return std::min(static_cast<std::size_t>(at), size > 1 ? size - 2 : 0);
}

/// Whether values may be NaN; checking costs a little time.
enum class Values { finite, any };

/// The value at a position in a cell.
/// @param corner  its first point
/// @param next    offsets to the neighbour along each axis; 0 where the grid has one layer
/// @param t       position in [0, 1]³. Where it is 0, NaN values of the neighbour have no effect
template <Values kValues, class T>
[[nodiscard]] double trilinear(const T *corner, const std::array<std::size_t, 3> &next, const Vec3 &t) {
  const auto between = [&](double a, double b, std::size_t axis) {
    if constexpr (kValues == Values::any)
      if (t[axis] == 0.0) return a;
    return a + t[axis] * (b - a);
  };
  const auto along = [&](const T *from) {
    return between(static_cast<double>(from[0]), static_cast<double>(from[next[0]]), 0);
  };
  const auto across = [&](const T *from) { return between(along(from), along(from + next[1]), 1); };
  return between(across(corner), across(corner + next[2]), 2);
}

}  // namespace c3de::imaging
