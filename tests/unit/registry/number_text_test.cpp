// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/number_text.h"

#include <string>

#include "support/catch.h"

using namespace c3de::registry;

TEST_CASE("typed numbers are read with or without their unit, and nothing else is") {
  CHECK(parseNumber("5e3", "Pa") == 5000.0);
  CHECK(parseNumber(" 5e3 Pa ", "Pa") == 5000.0);
  CHECK(parseNumber("+0.25", "") == 0.25);
  CHECK(parseNumber("-1m", "m") == -1.0);
  for (const char *text : {"", " ", "abc", "1,5", "1 2", "5 kPa", "Pa", "0x10"}) CHECK_FALSE(parseNumber(text, "Pa"));
}

TEST_CASE("text is copied into a plugin's buffer with its end, and cut between characters") {
  char buffer[6] = "xxxxx";
  CHECK(copyText(buffer, sizeof buffer, "liver"));
  CHECK(std::string(buffer) == "liver");
  CHECK_FALSE(copyText(buffer, sizeof buffer, "spleen"));
  CHECK(std::string(buffer) == "splee");
  CHECK_FALSE(copyText(buffer, sizeof buffer, "abcdé"));  // é has two bytes, one would fit
  CHECK(std::string(buffer) == "abcd");
  CHECK_FALSE(copyText(buffer, 0, "a"));
  CHECK_FALSE(copyText(nullptr, 5, "a"));
  const char full[3] = {'a', 'b', 'c'};
  CHECK(bufferText(full, 3) == "abc");
  CHECK(bufferText("ab\0c", 4) == "ab");
}
