// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "c3de/sdk/services.hpp"
#include "pointbased/stop_request.h"

namespace pointbased {

/// Whether the caller that waits for a body still wants it. Queries the caller's progress on the building thread, a few
/// times a second, in between the reports of the stages.
class BuildRequest final : public StopRequest {
 public:
  explicit BuildRequest(const c3de::sdk::Progress &progress) : progress_(progress) {}

  /// Reports the progress of a stage. @return false: not wanted any more
  [[nodiscard]] bool report(double fraction, std::string what) {
    fraction_ = fraction;
    what_ = std::move(what);
    ask();
    return !unwanted_;
  }

  [[nodiscard]] bool isRaised() const noexcept override {
    if (!unwanted_ && std::this_thread::get_id() == builder_ && std::chrono::steady_clock::now() - asked_ > kInterval)
      ask();
    return unwanted_;
  }

 private:
  static constexpr std::chrono::milliseconds kInterval{100};

  void ask() const noexcept {
    if (!progress_.update(fraction_, what_)) unwanted_ = true;
    asked_ = std::chrono::steady_clock::now();
  }

  const c3de::sdk::Progress &progress_;
  const std::thread::id builder_ = std::this_thread::get_id();
  double fraction_ = 0.0;
  std::string what_;
  mutable std::chrono::steady_clock::time_point asked_{};
  mutable std::atomic<bool> unwanted_{false};
};

}  // namespace pointbased
