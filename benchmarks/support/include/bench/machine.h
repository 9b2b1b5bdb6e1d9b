// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace bench {

/// The machine of a measurement.
struct Machine {
  std::string cpu;
  unsigned cores = 0;  ///< processors that this process may use at once, as reported by the system
};
[[nodiscard]] Machine machine();

struct Build {
  std::string version, compiler, type, sanitizers;
  bool assertions = false;
};
[[nodiscard]] Build build();

}  // namespace bench
