// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace c3de::geometry {

[[nodiscard]] inline std::string counted(std::size_t n, const char *one, const char *many) {
  return std::to_string(n) + ' ' + (n == 1 ? one : many);
}
[[nodiscard]] inline const char *wasOrWere(std::size_t n) { return n == 1 ? "was" : "were"; }

}  // namespace c3de::geometry
