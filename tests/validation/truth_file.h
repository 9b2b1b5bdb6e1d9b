// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

namespace validation {

struct ReferenceSolution {
  double value = 0.0, uncertainty = 0.0;
  std::string unit;
  std::array<double, 3> gravity{};  ///< of the case, m/s²; 0 where it has none
};
/// A value of truths/truths.json by its name; nullopt where the file does not contain it.
[[nodiscard]] std::optional<ReferenceSolution> truth(const std::string &name);

}  // namespace validation
