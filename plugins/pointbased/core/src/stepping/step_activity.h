// SPDX-License-Identifier: Apache-2.0
// What a step is busy with, for who waits for it. Private to the core.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <string>

#include "pointbased/body.h"
#include "pointbased/world_settings.h"

namespace pointbased::detail {

/// Why steps of a body may take long and what would help, in one line.
[[nodiscard]] std::string whatWouldHelp(const Body &body, const WorldSettings &world, Integrator integrator);

/// How far a step had come when it was given up, and how fast the body is.
struct Effort {
  double budget = 0.0;      ///< s, that a step may take
  double evaluation = 0.0;  ///< s, of its forces, measured
  int newtonSteps = 0, iterations = 0;
};
/// The body, how far it had come, and what fits into the budget by what was measured, in sentences.
[[nodiscard]] std::string whatWouldFit(const Body &body, const WorldSettings &world, Integrator integrator,
                                       const Effort &effort);

/// The body that is being computed, to be asked by any thread; the others are for the thread of the simulator.
class StepActivity {
 public:
  void describe(std::size_t body, std::string line) {
    const std::lock_guard lock(mutex_);
    lines_[body] = std::move(line);
  }
  void forget(std::size_t body) {
    const std::lock_guard lock(mutex_);
    lines_.erase(body);
  }
  /// @param body  0: none
  void enter(std::size_t body) { present_.store(body, std::memory_order_relaxed); }
  [[nodiscard]] std::size_t present() const { return present_.load(std::memory_order_relaxed); }

  /// Empty between steps.
  [[nodiscard]] std::string line() const {
    const std::lock_guard lock(mutex_);
    const auto found = lines_.find(present_.load(std::memory_order_relaxed));
    return found == lines_.end() ? std::string() : found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::size_t, std::string> lines_;
  std::atomic<std::size_t> present_{0};
};

}  // namespace pointbased::detail
