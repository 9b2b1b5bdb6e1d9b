// SPDX-License-Identifier: Apache-2.0
#include "c3de/tracking/tracking_address.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::tracking;

TEST_CASE("The address of a tracking system has a host and may have a port") {
  const auto plain = parseTrackingAddress("localhost");
  REQUIRE(plain);
  CHECK(textOf(*plain) == "localhost:18944");
  const auto full = parseTrackingAddress("10.0.0.7:65535");
  REQUIRE(full);
  CHECK(full->host == "10.0.0.7");
  CHECK(full->port == 65535);
}

TEST_CASE("An invalid address of a tracking system is refused with what is accepted") {
  for (const char *text : {"", ":18944", "host:", "host:0", "host:65536", "host:-1", "host:1.5", "host:18944x",
                           "two words", "host/path", "a:1:2", "\xc3\xa4"}) {
    INFO(text);
    const auto address = parseTrackingAddress(text);
    REQUIRE_FALSE(address);
    CHECK(address.error().code == ErrorCode::usage);
    CHECK_THAT(address.error().message, Contains("accepted: HOST or HOST:PORT"));
  }
}
