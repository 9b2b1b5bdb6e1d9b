// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

namespace c3de::study {

/// Removes a folder of intermediate outputs. On Windows files may stay open for a moment after their process has ended,
/// and cannot be removed meanwhile: it tries again, for 1 s in all. A folder that remains is no error.
inline void removeWorkFolder(const std::filesystem::path &folder) {
  constexpr int kTries = 20;
  std::error_code code;
  for (int i = 0; i < kTries; ++i) {
    std::filesystem::remove_all(folder, code);
    if (!code) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace c3de::study
