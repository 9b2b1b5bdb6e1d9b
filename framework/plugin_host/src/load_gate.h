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

  /// Why a file must not be opened; empty if it may.
  /// @param isNamed  the file was requested explicitly, which takes precedence over earlier choices
  [[nodiscard]] std::string reasonFileIsOff(const std::filesystem::path &file, bool isNamed);
  /// Why the plugin identified in a file must not be created.
  [[nodiscard]] std::string reasonIdIsOff(const std::string &id, bool isNamed);
  /// ErrorCode::plugin: the first use of the file, or of its changed version, has ended or blocked the process in which
  /// it was tried. The first time this takes as long as loading it, at most kMaxSeconds; later the stored result is
  /// used.
  [[nodiscard]] Expected<void> tryFirstUse(const std::filesystem::path &file);
  static constexpr double kMaxSeconds = 5.0;

  /// Names of LoadRules::without that matched no file and no plugin.
  [[nodiscard]] std::vector<std::string> unmatched() const;

 private:
  LoadRules rules_;
  std::set<std::string> matched_;
};

}  // namespace c3de::plugin_host
