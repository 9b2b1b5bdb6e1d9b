// SPDX-License-Identifier: Apache-2.0
#include "logic/row_search.h"

#include <vector>

#include "support/catch.h"

using namespace c3de::ui;
using Kind = RowSearch::Kind;

namespace {

/// A panel with a head, two sections and tooltips, as a plugin describes it in each frame.
struct Panel {
  RowSearch search;
  std::vector<std::string> drawn;

  void accept(const std::string &what) {
    if (const auto heading = search.takeHeading()) drawn.push_back("# " + *heading);
    drawn.push_back(what);
  }
  void row(const std::string &id, const std::string &label, const std::string &tooltip, Kind kind = Kind::widget) {
    if (search.row(id, label + '\n' + id, kind)) accept(id);
    search.tooltip(tooltip);
  }
  std::vector<std::string> draw(const std::string &words) {
    search.setWords(words);
    search.begin();
    drawn.clear();
    row("warning", "The surface is open", "");
    search.heading("Material");
    row("material.youngs_modulus", "Young's modulus", "Stiffness of the tissue", Kind::parameter);
    row("material.density", "Density", "Mass per volume", Kind::parameter);
    search.heading("Solver");
    row("solver.dt", "Step", "Size of a step; of stiff tissue it is small", Kind::parameter);
    if (search.follower("a bar without a name")) accept("bar");
    search.end();
    return drawn;
  }
};

using Rows = std::vector<std::string>;

}  // namespace

TEST_CASE("every word of a search must occur, in any order, whatever the case") {
  CHECK(containsWords("Young's modulus", "young"));
  CHECK(containsWords("Young's modulus\nmaterial.youngs_modulus", "MODULUS material"));
  CHECK(containsWords("material.youngs_modulus", "youngs modulus"));
  CHECK(containsWords("contact_pressure", "contact pressure"));
  CHECK(containsWords("contact_pressure", "contact_pressure"));
  CHECK_FALSE(containsWords("Young's modulus", "young density"));
  CHECK(containsWords("Müller's volume conservation", "MÜLLER"));
  CHECK(containsWords("ÀÖØÞ", "àöøþ"));
  CHECK_FALSE(containsWords("2 × 3", "2 ÷ 3"));
  CHECK(containsWords("anything", ""));
  CHECK(containsWords("anything", "  . _"));
  CHECK_FALSE(containsWords("", "x"));
}

TEST_CASE("a search finds rows by label, id and tooltip, below the headings of their sections") {
  Panel panel;
  CHECK(panel.draw("").size() == 7);
  CHECK(panel.search.rowCount() == 4);
  CHECK(panel.draw("density") == Rows{"warning", "# Material", "material.density"});
  CHECK(panel.search.matchCount() == 1);
  CHECK(panel.draw("solver.dt") == Rows{"warning", "# Solver", "solver.dt", "bar"});
  CHECK(panel.draw("per volume") == Rows{"warning", "# Material", "material.density"});
  CHECK(panel.draw("tissue stiff") ==
        Rows{"warning", "# Material", "material.youngs_modulus", "# Solver", "solver.dt", "bar"});
  CHECK(panel.search.matchCount() == 2);
  CHECK(panel.search.rowCount() == 4);
}

TEST_CASE("the name of a section finds all of its rows") {
  Panel panel;
  (void)panel.draw("");
  CHECK(panel.draw("material") == Rows{"warning", "# Material", "material.youngs_modulus", "material.density"});
}

TEST_CASE("a search without a hit counts none, and leaves the head of the panel with its warnings") {
  Panel panel;
  (void)panel.draw("");
  CHECK(panel.draw("viscosity") == Rows{"warning"});
  CHECK(panel.search.matchCount() == 0);
  CHECK(panel.draw(" ").size() == 7);
}

TEST_CASE("a bar without a name follows the row before it") {
  Panel panel;
  (void)panel.draw("");
  CHECK(panel.draw("dt").back() == "bar");
  CHECK(panel.draw("density").back() == "material.density");
  CHECK(panel.draw("without a name") == Rows{"warning", "# Solver", "bar"});
}

TEST_CASE("a panel without headings has no head: all of its rows are filtered") {
  RowSearch search;
  for (const char *words : {"", "blue"}) {
    search.setWords(words);
    search.begin();
    CHECK(search.row("red", "Red") == !search.isActive());
    CHECK(search.row("blue", "Blue"));
    search.end();
  }
  CHECK(search.matchCount() == 1);
}

TEST_CASE("parameters before the first heading are filtered, too") {
  RowSearch search;
  for (const char *words : {"", "blue"}) {
    search.setWords(words);
    search.begin();
    CHECK(search.row("warning", "Warning"));
    CHECK(search.row("red", "Red", Kind::parameter) == !search.isActive());
    search.heading("Section");
    search.end();
  }
}
