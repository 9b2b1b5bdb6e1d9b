// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "c3de/abi/iface/simulator.h"

namespace c3de::session {

/// During its lifetime, steps of a simulator end early once the program is interrupted or the deadline has passed.
/// Steps of a simulator that does not support this (below revision 4) run to completion.
class StepLimit {
 public:
  StepLimit(c3de_object *simulator, const c3de_simulator_v1 *table,
            std::optional<std::chrono::steady_clock::time_point> deadline);
  ~StepLimit();
  StepLimit(const StepLimit &) = delete;
  StepLimit &operator=(const StepLimit &) = delete;

 private:
  void watch();

  c3de_object *simulator_;
  const c3de_simulator_v1 *table_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace c3de::session
