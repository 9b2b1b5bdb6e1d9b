// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace c3de::plugin_host {

/// Error that a plugin reports for a failed call.
struct PluginError {
  std::string text;   ///< empty: the plugin reported nothing
  std::string table;  ///< kind of argument concerned, for example "fix"; empty: none in particular
  std::uint32_t index = 0;
  std::string key;  ///< a parameter or member; empty: none
};

/// With the location in front: "fix 2: the region meets no part of the body".
[[nodiscard]] std::string describe(const PluginError &error);

}  // namespace c3de::plugin_host
