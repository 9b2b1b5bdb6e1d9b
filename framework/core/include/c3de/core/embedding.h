// SPDX-License-Identifier: Apache-2.0
// What differs where another program has loaded this code as a library.
#pragma once

#include <cfenv>
#include <filesystem>

namespace c3de {

/// The file that contains this code: the program, or the shared library that another program has loaded. Plugins and
/// resources are found relative to its folder.
[[nodiscard]] std::filesystem::path modulePath();

/// From now on this code is a guest of another program: log() writes nothing to stderr (its listener still receives every
/// line), calls of plugins do not restore the locale that was present at the first of them, and the end of the process is
/// nobody's mistake. Any thread; before the first plugin is loaded.
void becomeGuest();
[[nodiscard]] bool isGuest();

/// During its lifetime this thread computes with the default floating-point environment and reads and writes numbers as in
/// the locale "C", whatever its program has set. Nested ones cost as much as the first, about 0.1 µs.
class OwnEnvironment {
 public:
  OwnEnvironment();
  ~OwnEnvironment();
  OwnEnvironment(const OwnEnvironment &) = delete;
  OwnEnvironment &operator=(const OwnEnvironment &) = delete;

 private:
  std::fenv_t before_{};
  void *locale_ = nullptr;  ///< of this thread before, where the system has one
};

}  // namespace c3de
