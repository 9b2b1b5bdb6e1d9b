// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>

namespace c3de::scene {

using Clock = std::chrono::steady_clock;

/// Due time of the next step, so that simulated time follows the wall clock at a rate.
class Pace {
 public:
  /// Associates simulated time `time_s` with now.
  void start(Clock::time_point now, double time_s) {
    anchor_ = now;
    anchorTime_s_ = time_s;
  }

  /// Due time of the step that ends at `end_s`. A step that is overdue by more than a small tolerance moves the anchor:
  /// lost time is not made up for by faster steps.
  /// @param rate  simulated seconds per second, > 0
  [[nodiscard]] Clock::time_point dueTime(double end_s, double rate, Clock::time_point now);

 private:
  Clock::time_point anchor_{};
  double anchorTime_s_ = 0.0;
};

/// Speed achieved over the last second of playing; paused time does not count.
class Meter {
 public:
  void clear();
  void pause() { running_ = false; }
  /// Records a step that took step_s of wall time and advanced simulated time by advance_s.
  void add(Clock::time_point now, double step_s, double advance_s);

  struct Rates {
    double wall_s = 0.0, simulated_s = 0.0, meanStep_s = 0.0;  ///< over the last second

    /// Simulated seconds per second while a step has been running for running_s. Constant while the step takes no
    /// longer than the previous ones, then decreasing, and 0 after another second without a result.
    [[nodiscard]] double realTimeFactor(double running_s = 0.0) const;
    /// Wall time of a step, s.
    [[nodiscard]] double step_s(double running_s = 0.0) const {
      return running_s > meanStep_s ? running_s : meanStep_s;
    }
  };
  [[nodiscard]] Rates rates() const {
    return {wall_s_, simulated_s_, samples_.empty() ? 0.0 : computing_s_ / static_cast<double>(samples_.size())};
  }

 private:
  struct Sample {
    double wall_s, step_s, advance_s;
  };
  std::deque<Sample> samples_;
  double wall_s_ = 0.0, computing_s_ = 0.0, simulated_s_ = 0.0;  ///< sums over the samples
  Clock::time_point last_{};
  bool running_ = false;
};

}  // namespace c3de::scene
