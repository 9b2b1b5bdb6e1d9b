// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace c3de::session {

/// Wall time of the steps of a run in bounded memory: for very many steps only every second, fourth, … is stored. The
/// largest is always stored.
class StepTimes {
 public:
  void add(double step_ms);
  /// All 0 before the first step.
  struct Summary {
    double median = 0.0, p99 = 0.0, max = 0.0;  ///< ms
  };
  [[nodiscard]] Summary summary() const;

 private:
  std::vector<double> kept_;
  std::size_t stride_ = 1, count_ = 0;
  double max_ = 0.0;
};

}  // namespace c3de::session
