// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "c3de/abi/iface/simulator.h"

/// A simulator without physics: counts its calls, for tests of the code that drives it. The counters may be read from
/// any thread.
class FakeSimulator {
 public:
  FakeSimulator();
  FakeSimulator(const FakeSimulator &) = delete;
  FakeSimulator &operator=(const FakeSimulator &) = delete;

  [[nodiscard]] c3de_object *object() { return &shared_.object; }
  [[nodiscard]] int references() const { return references_; }

  std::atomic<double> dt_s{1e-3};
  std::atomic<std::int64_t> stepCost_us{0};      ///< duration of a step
  std::atomic<std::uint64_t> failAtStep{0};      ///< 1: the first; 0: never
  std::atomic<std::uint64_t> givesUpStep{0};     ///< because it exceeds its time limit; 0: none
  std::atomic<std::uint64_t> finishesAtStep{0};  ///< a quasi-static solution: steps without time; 0: not one
  std::atomic<bool> resetFails{false};
  std::atomic<bool> standsStill{false};  ///< a step changes nothing
  std::atomic<std::uint64_t> steps{0}, resets{0}, publishes{0}, totalSteps{0};
  std::atomic<std::uint64_t> publishedStep{0};  ///< the state in the last snapshot
  std::atomic<std::uint32_t> tableSize{sizeof(c3de_simulator_v1)};
  std::atomic<bool> answersInterface{true};
  std::atomic<bool> endsSteps{true}, takesForces{true};  ///< those slots are not null
  std::atomic<std::uint64_t> endedSteps{0};              ///< steps that were ended early
  std::atomic<bool> interrupted{false};

  /// The forces on the points of its bodies, at the beginning of the last step.
  static constexpr std::size_t kPoints = 4;
  std::vector<std::vector<double>> forces{std::vector<double>(3 * kPoints)};  ///< of each body
  std::vector<std::vector<double>> acted;

 private:
  struct Shared {
    c3de_object object;
    FakeSimulator *owner;
  };
  static FakeSimulator &of(c3de_object *object) { return *reinterpret_cast<Shared *>(object)->owner; }
  static c3de_object_vt makeVt();
  static c3de_simulator_v1 makeTable();

  c3de_object_vt vt_ = makeVt();
  c3de_simulator_v1 table_ = makeTable();
  Shared shared_{};
  std::atomic<int> references_{1};
};
