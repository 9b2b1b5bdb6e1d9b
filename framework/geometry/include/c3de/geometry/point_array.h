// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace c3de::geometry {

/// Values at points, row by row, with the unit in the name: "displacement [mm]".
struct PointArray {
  enum class Type { real, whole };  ///< written as 32-bit float or as 32-bit integer
  std::string name;
  std::size_t components = 1;  ///< 9: a 3x3 matrix, row by row
  std::vector<double> values;  ///< rows * components
  Type type = Type::real;
};

}  // namespace c3de::geometry
