// SPDX-License-Identifier: Apache-2.0
// What differs where another program has loaded this code as a library.
#pragma once

#include <cfenv>
#include <filesystem>

namespace c3de {

/// The file that contains this code: the program, or the shared library that another program has loaded. Plugins and
/// resources are found relative to its folder.
[[nodiscard]] std::filesystem::path modulePath();

/// From now on this code is embedded in another program: log() writes nothing to stderr (its listener still receives
/// every line), calls of plugins do not restore the locale that was present at the first of them, and exit() during a
/// call is not reported as a plugin fault. Any thread; before the first plugin is loaded.
void setEmbedded();
[[nodiscard]] bool isEmbedded();

/// During its lifetime this thread computes with the default floating-point environment and reads and writes numbers as
/// in the locale "C", whatever its program has set. Nesting is allowed and costs the same, about 0.1 µs.
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
