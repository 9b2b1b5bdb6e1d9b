// SPDX-License-Identifier: Apache-2.0
// Numbers as a person reads them.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace pointbased {

/// So many digits behind the point.
[[nodiscard]] inline std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// So many digits that count.
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
