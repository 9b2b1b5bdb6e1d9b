// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <limits>
#include <stop_token>
#include <thread>
#include <vector>

#include "base/step_request.h"
#include "support/catch.h"

using namespace pointbased;
using namespace std::chrono_literals;

namespace {

constexpr double kBudget = 0.05;                 // s
constexpr std::int64_t kBeyond_ns = 80'000'000;  // of processor time; Windows counts in steps of 16 ms

void compute(std::int64_t time_ns) {
  const ThreadClock clock = ThreadClock::ofThisThread();
  const std::int64_t from = clock.now();
  while (clock.now() - from < time_ns) {
  }
}

}  // namespace

TEST_CASE("a step that waits while other threads compute is not given up, one that computes is") {
  StepInterrupt request;
  request.beginStep(kBudget);
  CHECK(request.budget() == kBudget);
  CHECK_FALSE(request.isRaised());
  // Software drawing: its computation does not count as work of the step.
  std::vector<std::thread> drawing;
  for (int k = 0; k < 3; ++k) drawing.emplace_back([] { compute(2 * kBeyond_ns); });
  for (std::thread &one : drawing) one.join();
  std::this_thread::sleep_for(200ms);
  CHECK_FALSE(request.isRaised());
  compute(kBeyond_ns);
  CHECK(request.isOverBudget());
  // From any of its threads.
  bool isRaised = false;
  std::thread([&] { isRaised = request.isRaised(); }).join();
  CHECK(isRaised);
  request.endStep();
  CHECK_FALSE(request.isRaised());
}

TEST_CASE("beside busy loops a step has the processor time of its budget") {
  std::vector<std::jthread> others;
  for (unsigned k = 0; k < 2 * std::max(1u, std::thread::hardware_concurrency()); ++k)
    others.emplace_back([](const std::stop_token &stop) {
      while (!stop.stop_requested()) {
      }
    });
  StepInterrupt request;
  const ThreadClock clock = ThreadClock::ofThisThread();
  const std::int64_t from = clock.now();
  request.beginStep(kBudget);
  while (!request.isRaised()) {
  }
  const double computed = 1e-9 * static_cast<double>(clock.now() - from);
  others.clear();
  CHECK(computed >= kBudget - 0.02);  // Windows: a step of its clock
  CHECK(computed < 2.0 * kBudget);
}

TEST_CASE("a step without a budget, and one that is spared because a hand has come, is not given up") {
  StepInterrupt request;
  request.beginStep(std::numeric_limits<double>::infinity());
  compute(kBeyond_ns);
  CHECK_FALSE(request.isRaised());
  request.endStep();
  request.beginStep(kBudget);
  request.liftStepBudget();
  compute(kBeyond_ns);
  CHECK_FALSE(request.isRaised());
  CHECK(request.budget() == std::numeric_limits<double>::infinity());
  // The user can still interrupt it.
  request.interrupt(true);
  CHECK(request.isRaised());
  request.interrupt(false);
  request.endStep();
  // The next one has a budget again.
  request.beginStep(kBudget);
  compute(kBeyond_ns);
  CHECK(request.isRaised());
}
