// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "c3de/core/platform.h"
#include "support/catch.h"
#include "trial_host.h"

namespace c3de::test {

class HostFixture : public validate::TrialHost {
 public:
  explicit HostFixture(bool headless = false)
      : TrialHost(freshSettingsFolder(), headless ? Serves::headless : Serves::all) {}

  static std::filesystem::path testPlugin(const std::string &name) {
    return std::filesystem::path(C3DE_TEST_PLUGINS) / (name + pluginExtension());
  }
  static std::filesystem::path hello() {
    return std::filesystem::path(testExampleFolder()) / (std::string("hello") + pluginExtension());
  }

  [[nodiscard]] std::size_t warnings() const {
    return linesFrom(LogLevel::warn).size() - linesFrom(LogLevel::error).size();
  }
  /// The handle in the line "made WHAT HANDLE" of a test plugin; null when the line is missing.
  [[nodiscard]] Handle madeBy(const std::string &what) const {
    for (const std::string &line : linesWith("made " + what + " ")) {
      const auto number = line.rfind(' ');
      return Handle::fromBits(std::stoull(line.substr(number + 1)));
    }
    return {};
  }
  [[nodiscard]] bool nothingIsRegistered() const { return leftOver().empty(); }

 private:
  static std::filesystem::path freshSettingsFolder() {
    static std::atomic<int> count{0};
    const auto folder = std::filesystem::path(testOutputRoot()) /
                        ("settings-" + std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) +
                         "-" + std::to_string(++count));
    std::filesystem::remove_all(folder);
    return folder;
  }
};

}  // namespace c3de::test
