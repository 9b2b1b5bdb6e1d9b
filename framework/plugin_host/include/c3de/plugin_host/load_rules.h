// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace c3de::plugin_host {

class PluginRecords;

/// Rules that decide which plugins may run, and what is tried before one does.
struct LoadRules {
  std::vector<std::string> without;        ///< ids, or file names, of plugins that are not loaded
  bool isSafeMode = false;                 ///< loads only the plugins that came with the program
  std::shared_ptr<PluginRecords> records;  ///< null: nothing is known, and nothing is stored
  std::filesystem::path prober;            ///< the program `c3de`, which tries the first use of a plugin in a separate
                                           ///< process; empty: not tried
  bool hasWindow = false;                  ///< services of a window are provided, also when a first use is tried
};

/// Folder of the plugins that came with the program: ../lib/c3de/plugins relative to it.
[[nodiscard]] std::filesystem::path ownPluginFolder();

}  // namespace c3de::plugin_host
