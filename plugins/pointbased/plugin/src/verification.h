// SPDX-License-Identifier: Apache-2.0
// The bodies of a simulator against their shadows: what was found, and how it is said.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pointbased/verification.h"

namespace pointbased {

struct BodyVerification {
  std::uint64_t id = 0, changes = 0;  ///< of the state that was verified: Simulator::changes()
  std::string name;
  std::vector<std::uint32_t> fixNumbers;
  std::string refused;  ///< empty: there is a result
  Verification result;
};

/// All bodies at one time.
struct WorldVerification {
  bool quasiStatic = false;
  double clock = 0.0;  ///< s, or load factor
  double seconds = 0.0;
  std::vector<BodyVerification> bodies;

  [[nodiscard]] const BodyVerification *body(std::uint64_t id) const {
    for (const BodyVerification &b : bodies)
      if (b.id == id) return &b;
    return nullptr;
  }
};

/// As iface.simulator verify() gives it.
[[nodiscard]] std::string verificationJson(const WorldVerification &verification);

}  // namespace pointbased
