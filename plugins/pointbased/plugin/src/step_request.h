// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "pointbased/stop_request.h"

namespace pointbased {

/// Why the step of a WorldSimulator should end before it is done. Any thread.
class StepRequest final : public StopRequest {
 public:
  /// A step that has taken this long is given up for what would change it anyway.
  static constexpr std::chrono::milliseconds kLong{500};

  [[nodiscard]] bool isRaised() const noexcept override {
    return interrupted_.load(std::memory_order_relaxed) || waiting_.load(std::memory_order_relaxed) > 0 ||
           abandoned_.load(std::memory_order_relaxed);
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

  void beginStep() {
    abandoned_ = false;
    begin_ = now();
  }
  void endStep() { begin_ = kNone; }

 private:
  static constexpr std::int64_t kNone = -1;
  static std::int64_t now() {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  std::atomic<bool> interrupted_{false}, abandoned_{false};
  std::atomic<int> waiting_{0};
  std::atomic<std::int64_t> begin_{kNone};  // ns of the present step
};

}  // namespace pointbased
