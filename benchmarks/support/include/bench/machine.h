// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace bench {

/// What figures were measured on.
struct Machine {
  std::string cpu;
  unsigned cores = 0;  ///< that this process may use at once, as the system tells
};
[[nodiscard]] Machine machine();

struct Build {
  std::string version, compiler, type, sanitizers;
  bool assertions = false;
};
[[nodiscard]] Build build();

}  // namespace bench
