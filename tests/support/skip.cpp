// SPDX-License-Identifier: Apache-2.0
// ctest interprets a line as the sign of a skipped case, whatever the exit code: it must not be printed where a check
// has failed.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using ListenerBase = Catch::EventListenerBase;
#else
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include <catch2/catch.hpp>
using ListenerBase = Catch::TestEventListenerBase;
#endif
#include <iostream>
#include <string>

namespace c3de::test {
namespace {

std::string &skipped() {
  static std::string reasons;
  return reasons;
}

}  // namespace

void skip(const std::string &reason) {
  std::cout << "skipped: " << reason << std::endl;
  skipped() += (skipped().empty() ? "" : "; ") + reason;
}

class SkipListener : public ListenerBase {
 public:
  using ListenerBase::ListenerBase;
  void testRunEnded(const Catch::TestRunStats &run) override {
    if (!skipped().empty() && run.totals.assertions.failed == 0 && run.totals.testCases.failed == 0)
      std::cout << "[C3DE-SKIPPED] " << skipped() << std::endl;
  }
};
CATCH_REGISTER_LISTENER(SkipListener)

}  // namespace c3de::test
