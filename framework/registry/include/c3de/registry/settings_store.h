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

/// Persistent settings of plugins: texts by key, a JSON file per plugin. Any thread.
///
/// A plugin's file is read when it is first requested. A damaged file is reported in the log, once, and renamed to
/// ID.json.damaged before a new one is written. None of its values are used, and other plugins are not affected. If two
/// programs write at the same time, the later one wins.
class SettingsStore {
 public:
  /// @param folder  need not exist; created when something is written. Empty: nothing is read or written, and values
  ///                exist as long as this object
  explicit SettingsStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  static constexpr std::size_t kMaxKeys = 1000, kLongestValue = std::size_t{1} << 20;

  [[nodiscard]] std::optional<std::string> get(const std::string &plugin, const std::string &key);
  /// On disk when this returns. ErrorCode::output: it could not be written, and the value applies to this run;
  /// ErrorCode::usage: too long, too many keys.
  [[nodiscard]] Expected<void> set(const std::string &plugin, const std::string &key, const std::string &value);
  /// False: nothing was set. Errors as for set().
  [[nodiscard]] Expected<bool> remove(const std::string &plugin, const std::string &key);
  [[nodiscard]] std::vector<std::string> keys(const std::string &plugin);

  [[nodiscard]] std::filesystem::path fileOf(const std::string &plugin) const;

 private:
  struct Values {
    std::map<std::string, std::string> byKey;
    bool isDamaged = false;  ///< the existing file
  };
  [[nodiscard]] Values &valuesOf(const std::string &plugin);
  [[nodiscard]] Expected<void> write(const std::string &plugin, Values &values);

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Values> plugins_;
};

/// Default location of settings: the folder "settings" in the user's settings folder. Empty after
/// keepSettingsInMemory().
[[nodiscard]] std::filesystem::path defaultSettingsFolder();
/// For a process that only tries plugins: settings written from now on are discarded when it ends. Called before a
/// session is created.
void keepSettingsInMemory();

}  // namespace c3de::registry
