// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

#include "pointbased/stop_request.h"
#include "thread_clock.h"

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
  /// s of processor time that the present step may take; infinite: no limit.
  [[nodiscard]] double budget() const noexcept {
    return end_ == kNever ? std::numeric_limits<double>::infinity() : 1e-9 * static_cast<double>(budget_);
  }
  /// The thread of the present step has computed for longer than it may. Time in which that thread waits for a processor
  /// does not count, nor does what other threads of the program compute.
  [[nodiscard]] bool isOverBudget() const noexcept {
    std::int64_t end = end_.load(std::memory_order_relaxed);
    const std::int64_t present = now();
    if (present <= end) return false;
    const std::int64_t left = budget_ - (clock_.now() - clockThen_);
    if (left <= 0) return true;
    end_.compare_exchange_strong(end, present + left, std::memory_order_relaxed);  // it cannot be over before
    return false;
  }

  /// By the host, until it is taken back.
  void interrupt(bool raised) { interrupted_ = raised; }
  /// The present step, if it has taken long: a material or a hand has changed, for which it would be computed in vain.
  void abandonLongStep() {
    const std::int64_t begin = begin_;
    if (begin != kNone && now() - begin > std::chrono::nanoseconds(kLong).count()) abandoned_ = true;
  }

  /// The present step has no limit any more: a hand has taken hold of tissue.
  void spareStep() { end_ = kNever; }

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

  /// On the thread of the step. @param budget  s of its processor time; infinite: no limit
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
  mutable std::atomic<std::int64_t> end_{kNever};       // ns of the wall: before it the budget cannot be used up
  // Of the thread of the present step; written while nobody computes.
  ThreadClock clock_;
  std::int64_t clockThen_ = 0;
};

}  // namespace pointbased
