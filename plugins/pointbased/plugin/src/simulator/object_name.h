// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace pointbased {

/// Identifies a body or an obstacle in a repeated simulation, where ids may differ. A rebuilt body and a restored
/// obstacle retain their name and number.
struct ObjectName {
  std::string name;
  std::uint32_t number = 1;  ///< among those of equal name, in the order in which they were added, from 1

  auto operator<=>(const ObjectName &) const = default;
  template <class Coder>
  void walk(Coder &coder) {
    coder(name, number);
  }
};
/// "plate", and "plate (2)" for the second one.
[[nodiscard]] inline std::string textOf(const ObjectName &of) {
  return of.number == 1 ? of.name : of.name + " (" + std::to_string(of.number) + ")";
}

}  // namespace pointbased
