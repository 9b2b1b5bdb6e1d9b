// SPDX-License-Identifier: Apache-2.0
// Formats numbers in messages. Private to the core.
#pragma once

#include <cstdio>
#include <string>

namespace pointbased::detail {

[[nodiscard]] inline std::string number(double value, int digits = 3) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace pointbased::detail
