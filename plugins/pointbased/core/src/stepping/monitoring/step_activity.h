// SPDX-License-Identifier: Apache-2.0
// Reports the activity of a running step. Private to the core.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "pointbased/body.h"
#include "pointbased/world_settings.h"

namespace pointbased::detail {

/// Why steps of a body may take long and what would help, in one line.
[[nodiscard]] std::string suggestRemedy(const Body &body, const WorldSettings &world, Integrator integrator);

/// How far a step had advanced when it was cancelled, and how fast the body is.
struct Effort {
  double dt = 0.0;          ///< s, the step; 0: a load step
  double budget = 0.0;      ///< s of wall-clock time for a step
  double evaluation = 0.0;  ///< s, measured for an evaluation of its forces
  int newtonSteps = 0, iterations = 0;
};
/// Sentences on the body, how far it had advanced, and what fits into the budget according to the measurement.
[[nodiscard]] std::string suggestAffordableStep(const Body &body, Integrator integrator, const Effort &effort);

/// The bodies that are being computed; may be queried by any thread.
class StepActivity {
 public:
  void describe(std::size_t body, std::string line) {
    const std::lock_guard lock(mutex_);
    lines_[body] = std::move(line);
  }
  void remove(std::size_t body) {
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
  /// The body that has been computed for longest; 0: none.
  [[nodiscard]] std::size_t present() const {
    const std::lock_guard lock(mutex_);
    return present_.empty() ? 0 : present_.front();
  }

  /// Line of that body; empty between steps.
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
