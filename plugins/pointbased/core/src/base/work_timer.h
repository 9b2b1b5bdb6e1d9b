// SPDX-License-Identifier: Apache-2.0
// Measures work on a machine with other load. Private to the core.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>

namespace pointbased::detail {

/// The smaller of wall-clock time and processor time of the process: the former counts for parallel loops, the latter
/// for interrupted work.
class WorkTimer {
 public:
  [[nodiscard]] double seconds() const {
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    return std::min(wall, static_cast<double>(std::clock() - processor_) / CLOCKS_PER_SEC);
  }

 private:
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  std::clock_t processor_ = std::clock();
};

}  // namespace pointbased::detail
