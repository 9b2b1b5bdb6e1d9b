// SPDX-License-Identifier: Apache-2.0
// The row under the mouse in a scrolling panel stays in place while rows above it appear and disappear.
#include "logic/scroll_anchor.h"

#include <string>
#include <vector>

#include "support/catch.h"

using c3de::ui::ScrollAnchor;

namespace {

constexpr double kHeight = 10.0, kVisible = 100.0;

/// A panel at the top of the screen, with rows of one height; scrolls within its contents as windows do.
struct Panel {
  ScrollAnchor anchor;
  double scroll = 0.0;
  std::map<std::string, double> shown;  ///< upper edges on the screen

  /// A frame. @param held  the mouse is over the panel at this height
  void draw(const std::vector<std::string> &rows, std::optional<double> mouse) {
    shown.clear();
    double y = -scroll;
    y += anchor.begin(y, kVisible, mouse);
    for (const std::string &row : rows) {
      y += anchor.row(row, y);
      shown[row] = y;
      y += kHeight;
    }
    scroll = anchor.end(scroll);
  }
};

std::vector<std::string> rows(int from, int to) {
  std::vector<std::string> all;
  for (int i = from; i <= to; ++i) all.push_back(std::to_string(i));
  return all;
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string> &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("The row under the mouse does not move in any frame, and others follow in the next", "[row_anchor]") {
  Panel panel;
  panel.scroll = 50.0;
  panel.draw(rows(0, 29), 45.0);
  REQUIRE(panel.shown["9"] == 40.0);
  const auto less = rows(0, 3) + rows(7, 29), more = rows(0, 3) + rows(100, 105) + rows(4, 29);
  panel.draw(less, 45.0);
  CHECK(panel.shown["9"] == 40.0);
  CHECK(panel.shown["10"] == 50.0);
  CHECK(panel.shown["3"] == -20.0);
  CHECK(panel.anchor.isSettling());
  panel.draw(less, 45.0);
  CHECK(panel.shown["9"] == 40.0);
  CHECK(panel.shown["3"] == 10.0);
  CHECK(panel.scroll == 20.0);
  CHECK_FALSE(panel.anchor.isSettling());
  for (int i = 0; i < 10; ++i) {
    panel.draw(i % 2 == 0 ? more : less, 45.0);
    CHECK(panel.shown["9"] == 40.0);
  }
  // Without the mouse there is no anchor.
  panel.draw(less, {});
  panel.draw(more, {});
  CHECK(panel.shown["9"] == 130.0);
}

TEST_CASE("Where the panel is not scrolled there is room above, until the mouse leaves", "[row_anchor]") {
  Panel panel;
  panel.draw(rows(0, 29), 45.0);
  REQUIRE(panel.shown["4"] == 40.0);
  panel.draw(rows(2, 29), 45.0);
  CHECK(panel.shown["4"] == 40.0);
  panel.draw(rows(2, 29), 45.0);
  CHECK(panel.shown["4"] == 40.0);
  CHECK(panel.shown["2"] == 20.0);
  CHECK(panel.scroll == 0.0);
  panel.scroll = 15.0;  // the user scrolls it
  panel.draw(rows(2, 29), 45.0);
  CHECK(panel.shown["4"] == 25.0);
  panel.draw(rows(2, 29), 45.0);
  CHECK(panel.shown["4"] == 25.0);
  panel.draw(rows(0, 29), 30.0);
  CHECK(panel.shown["4"] == 25.0);
  panel.draw(rows(2, 29), 30.0);
  panel.draw(rows(2, 29), {});
  panel.draw(rows(2, 29), {});
  CHECK(panel.shown["2"] == 0.0);
}

TEST_CASE("Where the row under the mouse goes, the next one stays", "[row_anchor]") {
  Panel panel;
  panel.scroll = 50.0;
  panel.draw(rows(0, 29), 45.0);
  panel.draw(rows(0, 5) + rows(12, 29), 45.0);
  CHECK(panel.shown["12"] == 70.0);
  panel.draw(rows(0, 5) + rows(12, 29), 45.0);
  CHECK(panel.shown["12"] == 70.0);
  CHECK(panel.shown["5"] == 60.0);
}

TEST_CASE("Rows that are put elsewhere do not take the panel with them", "[row_anchor]") {
  // As for a selected tool: its rows, 20 to 24, become the first.
  Panel panel;
  panel.scroll = 180.0;
  panel.draw(rows(0, 39), 35.0);
  REQUIRE(panel.shown["21"] == 30.0);
  const auto taken = rows(0, 1) + rows(20, 24) + rows(2, 19) + rows(25, 39);
  panel.draw(taken, 35.0);
  CHECK(panel.shown["25"] == 70.0);
  panel.draw(taken, 35.0);
  CHECK(panel.scroll == 180.0);
  CHECK(panel.shown["25"] == 70.0);
}

TEST_CASE("Nothing reaches into the row that is kept before it has come", "[row_anchor]") {
  ScrollAnchor anchor;
  const auto draw = [&](const std::vector<std::string> &all) {
    double y = anchor.begin(0.0, kVisible, 25.0);
    for (const std::string &row : all) {
      if (row == "2") CHECK(anchor.edge() == std::optional(20.0));
      y += anchor.row(row, y) + kHeight;
      if (row == "2") CHECK_FALSE(anchor.edge());
    }
    return anchor.end(0.0);
  };
  (void)anchor.begin(0.0, kVisible, 25.0);
  CHECK_FALSE(anchor.edge());
  for (int i = 0; i < 4; ++i) (void)anchor.row(std::to_string(i), kHeight * i);
  (void)anchor.end(0.0);
  CHECK(draw({"0", "1", "new", "newer", "2", "3"}) == 20.0);
  // A duplicate name refers only to its first row.
  ScrollAnchor twice;
  (void)twice.begin(0.0, kVisible, 25.0);
  for (const auto &[key, y] : {std::pair{"a", 0.0}, {"b", 10.0}, {"a", 20.0}}) (void)twice.row(key, y);
  (void)twice.end(0.0);
  (void)twice.begin(0.0, kVisible, 25.0);
  CHECK(twice.row("a", 0.0) == 0.0);
  CHECK(twice.row("c", 10.0) == 0.0);
  CHECK(twice.row("b", 20.0) == -10.0);
}
