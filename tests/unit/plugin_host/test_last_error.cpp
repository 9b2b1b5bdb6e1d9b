// SPDX-License-Identifier: Apache-2.0
#include "last_error.h"

#include <thread>

#include "refusal.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::plugin_host;

TEST_CASE("the last error is kept per thread and cleared by reading") {
  setLastError("here");
  std::string elsewhere = "not read";
  std::thread([&] { elsewhere = takeLastError(); }).join();
  CHECK(elsewhere.empty());
  CHECK(takeLastError() == "here");
  CHECK(takeLastError().empty());
}

TEST_CASE("every status has a name") {
  CHECK(statusName(C3DE_OK) == "C3DE_OK");
  CHECK(statusName(C3DE_E_ARG) == "C3DE_E_ARG");
  CHECK(statusName(C3DE_E_DIVERGED) == "C3DE_E_DIVERGED");
  CHECK(statusName(C3DE_E_INTERNAL) == "C3DE_E_INTERNAL");
  CHECK(statusName(-4711) == "status -4711");
  CHECK(statusName(INT32_MIN) == "status -2147483648");
}

TEST_CASE("an error code that went through a status is the same kind of thing afterwards") {
  for (const ErrorCode code : {ErrorCode::usage, ErrorCode::input, ErrorCode::plugin, ErrorCode::diverged,
                               ErrorCode::graphics, ErrorCode::cancelled, ErrorCode::state, ErrorCode::internal})
    CHECK(errorCodeOf(statusOf(code)) == code);
}

TEST_CASE("what a function throws becomes a status with a text") {
  const auto statusOfThrown = [](auto &&thrown) {
    try {
      throw thrown;
    } catch (...) {
      return refuse("service.function");
    }
  };
  CHECK(statusOfThrown(Refusal(C3DE_E_STALE, "gone")) == C3DE_E_STALE);
  CHECK(takeLastError() == "service.function: gone");
  CHECK(statusOfThrown(std::bad_alloc()) == C3DE_E_NOMEM);
  CHECK(takeLastError() == "service.function: out of memory");
  CHECK(statusOfThrown(std::runtime_error("odd")) == C3DE_E_EXCEPTION);
  CHECK(takeLastError() == "service.function: odd");
  CHECK(statusOfThrown(42) == C3DE_E_EXCEPTION);
  CHECK_FALSE(takeLastError().empty());
}

TEST_CASE("a call without a plugin behind it is refused") {
  CHECK(serve(nullptr, "service.function", [](PluginContext &) {}) == C3DE_E_ARG);
  CHECK(takeLastError() == "service.function: ctx is null");
}
