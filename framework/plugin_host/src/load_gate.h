// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>

#include "c3de/core/expected.h"
#include "c3de/plugin_host/load_rules.h"

namespace c3de::plugin_host {

/// Decides whether a plugin may be loaded. Main thread.
class LoadGate {
 public:
  explicit LoadGate(LoadRules rules) : rules_(std::move(rules)) {}

  /// Why a file is not to be opened; empty: it may be.
  /// @param isNamed  somebody has asked for this file, which counts more than what was chosen earlier
  [[nodiscard]] std::string offByFile(const std::filesystem::path &file, bool isNamed);
  /// Why the plugin that a file has turned out to be is not to be created.
  [[nodiscard]] std::string offById(const std::string &id, bool isNamed);
  /// ErrorCode::plugin: the first use of the file, or of what it has become, has ended or stopped the process in which
  /// it was tried. Takes as long as loading it does, and at most kMostSeconds, the first time; then it is known.
  [[nodiscard]] Expected<void> tryFirstUse(const std::filesystem::path &file);
  static constexpr double kMostSeconds = 5.0;

  /// Names of LoadRules::without that no file and no plugin had.
  [[nodiscard]] std::vector<std::string> unmatched() const;

 private:
  LoadRules rules_;
  std::set<std::string> matched_;
};

}  // namespace c3de::plugin_host
