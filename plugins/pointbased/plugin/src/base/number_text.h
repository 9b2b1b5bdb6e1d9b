// SPDX-License-Identifier: Apache-2.0
// Numbers as display text.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace pointbased {

/// With this many decimal places.
[[nodiscard]] inline std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// With this many significant digits.
[[nodiscard]] inline std::string significant(double value, int digits = 3) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// Two significant digits, or all before the point: "0.0012", "87", "1234".
[[nodiscard]] inline std::string twoDigits(double value) {
  return std::abs(value) < 99.5 ? significant(value, 2) : fixed(value, 0);
}

}  // namespace pointbased
