// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "c3de/core/platform.h"
#include "support/catch.h"

using namespace c3de;

TEST_CASE("A file is held by one at a time, and the second reads what the first has noted") {
  const auto file = testOutputFolder() / "lock";
  std::optional<FileLock> held;
  {
    auto first = FileLock::take(file, "process 7");
    REQUIRE(first);
    held.emplace(std::move(*first));
  }
  const auto second = FileLock::take(file, "process 8");
  REQUIRE_FALSE(second);
  CHECK(second.error().code == ErrorCode::state);
  CHECK(second.error().message == "process 7");
  held.reset();
  CHECK(FileLock::take(file, "process 8"));
}

TEST_CASE("A lock in a folder that is not there is an output that cannot be written") {
  const auto lock = FileLock::take(testOutputFolder() / "absent" / "lock", "");
  REQUIRE_FALSE(lock);
  CHECK(lock.error().code == ErrorCode::output);
}

TEST_CASE("The processor time of a process grows while it computes") {
  const double before = processorTime_s();
  volatile double sum = 0.0;
  while (processorTime_s() < before + 0.01) sum = sum + 1.0;
  CHECK(processorTime_s() >= before + 0.01);
}
