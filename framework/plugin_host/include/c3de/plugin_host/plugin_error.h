// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace c3de::plugin_host {

/// What a plugin says of a call that failed.
struct PluginError {
  std::string text;   ///< empty: nothing was said
  std::string table;  ///< of the things it was given, for example "fix"; empty: none in particular
  std::uint32_t index = 0;
  std::string key;  ///< a parameter or member; empty: none
};

/// With the place in front: "fix 2: the region meets no part of the body".
[[nodiscard]] std::string describe(const PluginError &error);

}  // namespace c3de::plugin_host
