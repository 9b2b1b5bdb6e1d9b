// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "c3de/core/expected.h"

namespace c3de::registry {

/// What plugins remember from one run to the next: texts by key, a JSON file per plugin. Any thread.
///
/// A plugin's file is read when it is first asked for. One that is damaged is told in the log, once, and put aside as
/// ID.json.damaged before anything is written in its place; nothing of it counts, and nothing of other plugins is
/// touched. Of two programs that write at the same time the later one wins.
class SettingsStore {
 public:
  /// @param folder  need not be there; made when something is written. Empty: nothing is read or written, and values
  ///                last as long as this
  explicit SettingsStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  static constexpr std::size_t kMostKeys = 1000, kLongestValue = std::size_t{1} << 20;

  [[nodiscard]] std::optional<std::string> get(const std::string &plugin, const std::string &key);
  /// On disk when this returns. ErrorCode::output: it could not be written, the value holds for this run;
  /// ErrorCode::usage: too long, too many keys.
  [[nodiscard]] Expected<void> set(const std::string &plugin, const std::string &key, const std::string &value);
  /// False: nothing was set. Errors as of set().
  [[nodiscard]] Expected<bool> remove(const std::string &plugin, const std::string &key);
  [[nodiscard]] std::vector<std::string> keys(const std::string &plugin);

  [[nodiscard]] std::filesystem::path fileOf(const std::string &plugin) const;

 private:
  struct Values {
    std::map<std::string, std::string> byKey;
    bool isDamaged = false;  ///< the file that is there
  };
  [[nodiscard]] Values &valuesOf(const std::string &plugin);
  [[nodiscard]] Expected<void> write(const std::string &plugin, Values &values);

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Values> plugins_;
};

/// Where settings lie unless somebody says otherwise: the folder "settings" in the person's folder of settings; after
/// keepSettingsInMemory(), empty.
[[nodiscard]] std::filesystem::path defaultSettingsFolder();
/// For a process that only tries plugins: what they set from now on ends with it. Before a session is made.
void keepSettingsInMemory();

}  // namespace c3de::registry
