// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace c3de::plugin_host {

class PluginRecords;

/// Which plugins may run, and what is tried before one does.
struct LoadRules {
  std::vector<std::string> without;        ///< ids, or names of files, that are not loaded
  bool isSafeMode = false;                 ///< only those that came with the program
  std::shared_ptr<PluginRecords> records;  ///< null: nothing is known, and nothing is kept
  std::filesystem::path prober;            ///< the program `c3de`, which tries the first use of a plugin in a process
                                           ///< of its own; empty: that is not tried
  bool hasWindow = false;                  ///< what a window has is served, also where a first use is tried
};

/// Where the plugins that came with the program lie: ../lib/c3de/plugins beside it.
[[nodiscard]] std::filesystem::path ownPluginFolder();

}  // namespace c3de::plugin_host
