// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/csv.h"

#include "support/catch.h"

using namespace c3de;

TEST_CASE("Cells of CSV come back as they were, commas, quotes and empty ones too") {
  for (const std::string text : {"", "tip", "a,b", "say \"no\"", "\"", ",", "x [m]"}) {
    const auto cells = splitCsvRow(csvCell(text) + "," + csvCell("end"));
    INFO(text);
    REQUIRE(cells);
    REQUIRE(cells->size() == 2);
    CHECK(cells->front() == text);
    CHECK(cells->back() == "end");
  }
  CHECK(csvCell("plain") == "plain");
  CHECK(splitCsvRow("a,b\r")->back() == "b");
  CHECK(splitCsvRow("")->size() == 1);
  CHECK_FALSE(splitCsvRow("\"open,b"));
}
