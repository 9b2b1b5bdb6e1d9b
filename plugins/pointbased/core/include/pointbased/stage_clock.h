// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace pointbased {

/// Wall time per stage of the step, over the most recent calls.
class StageClock {
 public:
  struct Summary {
    std::string name;
    double median_ms = 0.0, p99_ms = 0.0;
    std::size_t calls = 0;
  };

  explicit StageClock(std::vector<std::string> names);

  /// Adds the duration of f() to a stage.
  template <class F>
  void measure(std::size_t stage, F &&f) {
    const auto begin = std::chrono::steady_clock::now();
    f();
    stages_[stage].pending_ms +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    stages_[stage].used = true;
  }
  /// Moves the uncommitted measurements of a clock with the same stages to this one.
  void take(StageClock &other);
  /// Ends a call: measurements since the last commit count as one sample per stage.
  void commit();
  void clear();
  /// Stages that ran, in order.
  [[nodiscard]] std::vector<Summary> summary() const;

 private:
  struct Stage {
    std::string name;
    double pending_ms = 0.0;
    bool used = false;
    std::size_t calls = 0;
    std::vector<float> recent_ms;  // ring buffer of kRecent
  };
  static constexpr std::size_t kRecent = 2048;
  std::vector<Stage> stages_;
};

}  // namespace pointbased
