// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace c3de::session {

/// The class and plugin of a simulator.
struct SimulatorIdentity {
  std::string classId, label, plugin, version;  ///< plugin: id and version

  friend bool operator==(const SimulatorIdentity &, const SimulatorIdentity &) = default;
};

}  // namespace c3de::session
