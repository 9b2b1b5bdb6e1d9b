// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>

namespace c3de::scene {

using Clock = std::chrono::steady_clock;

/// When the next step is due, so that simulated time follows the wall clock at a rate.
class Pace {
 public:
  /// From here on simulated time `time_s` belongs to now.
  void start(Clock::time_point now, double time_s) {
    anchor_ = now;
    anchorTime_s_ = time_s;
  }

  /// When the step that ends at `end_s` should be done. A step that is overdue by more than a little moves the anchor:
  /// time that was lost is lost, later steps are not hurried to make up for it.
  /// @param rate  simulated seconds per second, > 0
  [[nodiscard]] Clock::time_point dueTime(double end_s, double rate, Clock::time_point now);

 private:
  Clock::time_point anchor_{};
  double anchorTime_s_ = 0.0;
};

/// What was achieved over the last second of playing; time that was spent paused does not count.
class Meter {
 public:
  void clear();
  void pause() { running_ = false; }
  /// A step has ended: it took step_s of wall time and brought simulated time forward by advance_s.
  void add(Clock::time_point now, double step_s, double advance_s);

  struct Rates {
    double wall_s = 0.0, simulated_s = 0.0, meanStep_s = 0.0;  ///< over the last second

    /// Simulated seconds per second while a step has been computed for running_s without an end: as it was while a step
    /// takes as long as those before it, then less and less, and nothing when for a second nothing has come of it.
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
