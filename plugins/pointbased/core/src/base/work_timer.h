// SPDX-License-Identifier: Apache-2.0
// Measures work on a machine with other load. Private to the core.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>

namespace pointbased::detail {

/// The smaller of wall-clock time and processor time of the process: the former counts for parallel loops, the latter
/// for interrupted work. On Windows always the former.
class WorkTimer {
 public:
  [[nodiscard]] double seconds() const {
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
#if defined(_WIN32)
    return wall;  // clock() is a wall clock there, in whole milliseconds: short work would take none
#else
    return std::min(wall, static_cast<double>(std::clock() - processor_) / CLOCKS_PER_SEC);
#endif
  }

 private:
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
#if !defined(_WIN32)
  std::clock_t processor_ = std::clock();
#endif
};

}  // namespace pointbased::detail
