// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <ctime>
#include <limits>
#include <thread>

#include "step_request.h"
#include "support/catch.h"

using namespace pointbased;
using namespace std::chrono_literals;

TEST_CASE("a step that waits for its turn on a busy machine is not given up, one that computes is") {
  constexpr double kBudget = 0.05;
  StepRequest request;
  request.beginStep(kBudget);
  CHECK_FALSE(request.isRaised());
#ifndef _WIN32  // whose std::clock() is that of the wall
  std::this_thread::sleep_for(200ms);
  CHECK_FALSE(request.isRaised());
#endif
  const std::clock_t from = std::clock();
  while (std::clock() - from < 1.2 * kBudget * CLOCKS_PER_SEC) {
  }
  std::this_thread::sleep_for(60ms);
  CHECK(request.isOverBudget());
  CHECK(request.isRaised());
  request.endStep();
  CHECK_FALSE(request.isRaised());
  // Without a budget it takes as long as it likes.
  request.beginStep(std::numeric_limits<double>::infinity());
  CHECK_FALSE(request.isRaised());
}
