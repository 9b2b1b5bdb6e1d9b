// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/thread_clock.h"
#include "pointbased/stop_request.h"

namespace pointbased {

/// Why the step of a WorldSimulator should end before it is complete. Any thread.
class StepInterrupt final : public StopRequest {
 public:
  /// A step that has taken this long is abandoned in favour of a change that would invalidate it anyway.
  static constexpr std::chrono::milliseconds kLong{500};

  [[nodiscard]] bool isRaised() const noexcept override {
    return interrupted_.load(std::memory_order_relaxed) || waiting_.load(std::memory_order_relaxed) > 0 ||
           abandoned_.load(std::memory_order_relaxed) || isOverBudget();
  }
  /// s of processor time that the present step may use; infinite: no limit.
  [[nodiscard]] double budget() const noexcept {
    return end_ == kNever ? std::numeric_limits<double>::infinity() : 1e-9 * static_cast<double>(budget_);
  }
  /// The thread of the present step has computed for longer than its budget. Time in which that thread waits for a
  /// processor does not count, nor does the computing time of other threads of the program.
  [[nodiscard]] bool isOverBudget() const noexcept {
    std::int64_t end = end_.load(std::memory_order_relaxed);
    const std::int64_t present = now();
    if (present <= end) return false;
    const std::int64_t left = budget_ - (clock_.now() - clockThen_);
    if (left <= 0) return true;
    end_.compare_exchange_strong(end, present + left, std::memory_order_relaxed);  // the budget cannot be exceeded
                                                                                   // before
    return false;
  }

  /// Set by the host, until withdrawn.
  void interrupt(bool raised) { interrupted_ = raised; }
  /// Abandons the present step if it has taken long: a material or an interactive tool has changed, so its result would
  /// be discarded.
  void abandonLongStep() {
    const std::int64_t begin = begin_;
    if (begin != kNone && now() - begin > std::chrono::nanoseconds(kLong).count()) abandoned_ = true;
  }

  /// Removes the limit of the present step: an interactive tool has taken hold of tissue.
  void liftStepBudget() { end_ = kNever; }

  /// While an instance exists, a caller waits to reset the simulator: no step is worth completing.
  class Waiting {
   public:
    explicit Waiting(StepInterrupt &request) : request_(request) { ++request_.waiting_; }
    ~Waiting() { --request_.waiting_; }
    Waiting(const Waiting &) = delete;
    Waiting &operator=(const Waiting &) = delete;

   private:
    StepInterrupt &request_;
  };

  /// Called on the thread of the step. @param budget  s of its processor time; infinite: no limit
  void beginStep(double budget) {
    const bool isLimited = std::isfinite(budget);
    abandoned_ = false;
    if (isLimited) clock_ = ThreadClock::ofThisThread();
    clockThen_ = clock_.now();
    begin_ = now();
    budget_ = isLimited ? static_cast<std::int64_t>(1e9 * budget) : 0;
    end_ = isLimited ? begin_ + budget_ : kNever;
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
  std::atomic<std::int64_t> begin_{kNone}, budget_{0};  // ns, of the present step
  mutable std::atomic<std::int64_t> end_{kNever};       // ns of wall time before which the budget cannot be exceeded
  // Of the thread of the present step; written while no step runs.
  ThreadClock clock_;
  std::int64_t clockThen_ = 0;
};

}  // namespace pointbased
