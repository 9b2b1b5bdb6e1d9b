// SPDX-License-Identifier: Apache-2.0
// What a step is busy with, for who waits for it. Private to the core.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/world_settings.h"

namespace pointbased::detail {

/// Why steps of a body may take long and what would help, in one line.
[[nodiscard]] std::string whatWouldHelp(const Body &body, const WorldSettings &world, Integrator integrator);

/// How far a step had come when it was given up, and how fast the body is.
struct Effort {
  double dt = 0.0;          ///< s, the step; 0: a load step
  double budget = 0.0;      ///< s, that it may take
  double evaluation = 0.0;  ///< s, of its forces, measured
  int newtonSteps = 0, iterations = 0;
};
/// The body, how far it had come, and what fits into the budget by what was measured, in sentences.
[[nodiscard]] std::string whatWouldFit(const Body &body, Integrator integrator, const Effort &effort);

/// The bodies that are being computed, to be asked by any thread.
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
  void enter(std::size_t body) {
    const std::lock_guard lock(mutex_);
    present_.push_back(body);
  }
  void leave(std::size_t body) {
    const std::lock_guard lock(mutex_);
    std::erase(present_, body);
  }
  void leaveAll() {
    const std::lock_guard lock(mutex_);
    present_.clear();
  }
  /// The one that has been computed for longest; 0: none.
  [[nodiscard]] std::size_t present() const {
    const std::lock_guard lock(mutex_);
    return present_.empty() ? 0 : present_.front();
  }

  /// Of that one; empty between steps.
  [[nodiscard]] std::string line() const {
    const std::lock_guard lock(mutex_);
    const auto found = present_.empty() ? lines_.end() : lines_.find(present_.front());
    return found == lines_.end() ? std::string() : found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::size_t, std::string> lines_;
  std::vector<std::size_t> present_;  // in the order they were entered
};

}  // namespace pointbased::detail
