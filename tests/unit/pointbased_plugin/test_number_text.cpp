// SPDX-License-Identifier: Apache-2.0
#include "base/number_text.h"
#include "support/catch.h"

TEST_CASE("a number has two significant digits, or all before the point") {
  CHECK(pointbased::twoDigits(0.001234) == "0.0012");
  CHECK(pointbased::twoDigits(9.96) == "10");
  CHECK(pointbased::twoDigits(99.4) == "99");
  CHECK(pointbased::twoDigits(99.6) == "100");  // "%.2g" alone gives 1e+02
  CHECK(pointbased::twoDigits(-1234.4) == "-1234");
}
