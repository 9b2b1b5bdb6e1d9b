// SPDX-License-Identifier: Apache-2.0
// Verification of the bodies of a simulator against fine references: results and their JSON form.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pointbased/verification.h"

namespace pointbased {

struct BodyVerification {
  std::uint64_t id = 0, changes = 0;  ///< of the verified state: Stepper::changes()
  std::string name;
  std::vector<std::uint32_t> fixNumbers;
  std::string refused;  ///< reason; empty if there is a result
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

/// As iface.simulator verify() returns it.
[[nodiscard]] std::string verificationJson(const WorldVerification &verification);

}  // namespace pointbased
