// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <deque>
#include <vector>

namespace pointbased {

/// The force on an interactive tool over the last ten seconds of simulated time. One thread.
class ForceCurve {
 public:
  static constexpr double kInterval = 1.0 / 30.0;  ///< s
  static constexpr std::size_t kMaxSamples = 300;

  /// Adds a force, N, at a time, s. A time before the last one restarts the curve from there.
  void addSample(double force, double time) {
    if (time < nextSampleTime_ - 2.0 * kInterval || forces_.empty()) nextSampleTime_ = time;  // undone or restarted
    // A step may be longer than the interval.
    while (nextSampleTime_ <= time) {
      forces_.push_back(force);
      nextSampleTime_ += kInterval;
    }
    while (forces_.size() > kMaxSamples) forces_.pop_front();
  }
  void clear() { forces_.clear(); }
  /// N, every kInterval, the latest last.
  [[nodiscard]] std::vector<double> values() const { return {forces_.begin(), forces_.end()}; }
  [[nodiscard]] double largest() const {
    return forces_.empty() ? 0.0 : *std::max_element(forces_.begin(), forces_.end());
  }

 private:
  std::deque<double> forces_;
  double nextSampleTime_ = 0.0;  // s
};

}  // namespace pointbased
