// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace c3de::session {

/// Who simulates.
struct SimulatorIdentity {
  std::string classId, label, plugin, version;  ///< id and version of the plugin
};

}  // namespace c3de::session
