// SPDX-License-Identifier: Apache-2.0
// Paths to objects that are not regular files; POSIX only.
#pragma once

#include <filesystem>

#include "c3de/core/platform.h"
#include "support/catch.h"

namespace c3de::test {

/// A named pipe at this path without a writer: opening it would block.
inline std::filesystem::path pipeAt(const std::filesystem::path &path) {
  std::filesystem::remove(path);
  const auto made = runProcess({"mkfifo", path.string()}, 10.0);
  REQUIRE((made && made->exitCode == 0));
  return path;
}

}  // namespace c3de::test
