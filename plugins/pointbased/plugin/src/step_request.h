// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <limits>

#include "pointbased/stop_request.h"

namespace pointbased {

/// Why the step of a WorldSimulator should end before it is done. Any thread.
class StepRequest final : public StopRequest {
 public:
  /// A step that has taken this long is given up for what would change it anyway.
  static constexpr std::chrono::milliseconds kLong{500};

  [[nodiscard]] bool isRaised() const noexcept override {
    return interrupted_.load(std::memory_order_relaxed) || waiting_.load(std::memory_order_relaxed) > 0 ||
           abandoned_.load(std::memory_order_relaxed) || isOverBudget();
  }
  /// s that the present step may take; infinite: as long as it likes.
  [[nodiscard]] double budget() const noexcept {
    const std::int64_t begin = begin_, end = end_;
    return begin == kNone || end == kNever ? std::numeric_limits<double>::infinity()
                                           : 1e-9 * static_cast<double>(end - begin);
  }
  /// The present step has taken longer than it may, of processor time as well where that can be told: on a busy machine
  /// a short one may wait for its turn for a second.
  [[nodiscard]] bool isOverBudget() const noexcept {
    return now() > end_.load(std::memory_order_relaxed) &&
           static_cast<double>(std::clock() - clockThen_.load(std::memory_order_relaxed)) >= budget() * CLOCKS_PER_SEC;
  }

  /// By the host, until it is taken back.
  void interrupt(bool raised) { interrupted_ = raised; }
  /// The present step, if it has taken long: a material or a hand has changed, for which it would be computed in vain.
  void abandonLongStep() {
    const std::int64_t begin = begin_;
    if (begin != kNone && now() - begin > std::chrono::nanoseconds(kLong).count()) abandoned_ = true;
  }

  /// While it lives, somebody waits for the simulator to put it back to the beginning: no step is worth anything.
  class Waiting {
   public:
    explicit Waiting(StepRequest &request) : request_(request) { ++request_.waiting_; }
    ~Waiting() { --request_.waiting_; }
    Waiting(const Waiting &) = delete;
    Waiting &operator=(const Waiting &) = delete;

   private:
    StepRequest &request_;
  };

  /// @param budget  s, that it may take; infinite: as long as it likes
  void beginStep(double budget) {
    abandoned_ = false;
    clockThen_ = std::clock();
    begin_ = now();
    end_ = std::isfinite(budget) ? begin_ + static_cast<std::int64_t>(1e9 * budget) : kNever;
  }
  void endStep() {
    begin_ = kNone;
    end_ = kNever;
  }

 private:
  static constexpr std::int64_t kNone = -1, kNever = std::numeric_limits<std::int64_t>::max();
  static std::int64_t now() noexcept {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  std::atomic<bool> interrupted_{false}, abandoned_{false};
  std::atomic<int> waiting_{0};
  std::atomic<std::int64_t> begin_{kNone}, end_{kNever};  // ns, of the present step and of its budget
  std::atomic<std::clock_t> clockThen_{0};                // of the process, at the beginning
};

}  // namespace pointbased
