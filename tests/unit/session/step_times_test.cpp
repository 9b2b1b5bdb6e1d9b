// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/step_times.h"

#include "support/catch.h"

using namespace c3de::session;

TEST_CASE("Median, 99 % and largest are of the steps, in any order, and 0 without any") {
  StepTimes times;
  CHECK(times.summary().max == 0.0);
  for (int i = 0; i < 200; ++i) times.add((i * 77) % 200 + 1);  // 1 … 200
  CHECK(times.summary().median == 100.0);
  CHECK(times.summary().p99 == 198.0);
  CHECK(times.summary().max == 200.0);
}

TEST_CASE("Of very many steps the summary stays right, and the one that is largest is kept") {
  StepTimes times;
  const std::size_t count = (std::size_t{1} << 21) + 12345;
  for (std::size_t i = 0; i < count; ++i) times.add(static_cast<double>(i % 1009));
  times.add(5000.0);
  times.add(1.0);
  CHECK_THAT(times.summary().median, WithinAbs(504.0, 2.0));
  CHECK_THAT(times.summary().p99, WithinAbs(998.0, 2.0));
  CHECK(times.summary().max == 5000.0);
}
