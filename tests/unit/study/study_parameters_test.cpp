// SPDX-License-Identifier: Apache-2.0
#include "c3de/study/study_parameters.h"

#include <set>

#include "c3de/study/plan.h"
#include "support/catch.h"

using namespace c3de::study;

TEST_CASE("A grid is every combination of its values, each once") {
  const auto all =
      combinations({{"spacing", {"1", "2", "3"}, 0}, {"law", {"\"a\"", "\"b\""}, 0}, {"threads", {"4"}, 0}});
  CHECK(all.size() == 6);
  std::set<std::string> shownOnes;
  for (const auto &one : all) {
    CHECK(one.size() == 3);
    shownOnes.insert(shown(one));
  }
  CHECK(shownOnes.size() == 6);
  CHECK(all[1][0].value == "1");
  CHECK(all[1][1].value == "\"b\"");
}

TEST_CASE("Levers are scene paths: of all bodies, of the solver, or the path itself") {
  const auto spacing = settingsOf({"spacing", "0.01", 7}, {"liver", "kidney"});
  REQUIRE(spacing.size() == 2);
  CHECK(spacing[1].path == "body.kidney.sampling.spacing");
  CHECK(spacing[1].value == "0.01");
  CHECK(spacing[1].line == 7);
  CHECK(settingsOf({"law", "\"stvk\"", 0}, {"b"})[0].path == "body.b.material.law");
  CHECK(settingsOf({"simulator", "\"x\"", 0}, {"b"})[0].path == "simulator.class");
  CHECK(settingsOf({"substeps", "4", 0}, {"b"})[0].path == "solver.dt");
  CHECK(std::stod(settingsOf({"substeps", "4", 0}, {"b"})[0].value) == 1.0 / 60.0 / 4.0);
  CHECK(settingsOf({"fix.0.ramp", "2", 0}, {"b"})[0].path == "fix.0.ramp");
  CHECK(settingsOf({"threads", "2", 0}, {"b"}).empty());
}

TEST_CASE("Values are shown as people say them") {
  CHECK(shownValue({"spacing", "0.01", 0}) == "10 mm");
  CHECK(shownValue({"spacing", "0.0133", 0}) == "13.3 mm");
  CHECK(shownValue({"dt", "0.004166666666666667", 0}) == "4.17 ms");
  CHECK(shownValue({"dt", "\"auto\"", 0}) == "auto");
  CHECK(shownValue({"evaluation", "\"phyxels\"", 0}) == "phyxels");
  CHECK(refinementOf({"count", "1000", 0}) == 0.1);
  CHECK(refinementOf({"substeps", "8", 0}) == 0.125);
}

TEST_CASE("What differs between two studies is told by name, ids only where nothing else is") {
  const std::vector<std::pair<std::string, std::string>> one{
      {"repeat", "3"}, {"case a: scene", std::string(16, 'a')}, {"case a: x", std::string(16, '1')}};
  auto other = one;
  CHECK(difference(one, other).empty());
  other[0].second = "4";
  other[2].second = std::string(16, '2');
  CHECK(difference(one, other) == "'repeat' is 3 and was 4");
  other[0].second = "3";
  CHECK(difference(one, other) == "'case a: x' has changed");
  other[1].second = std::string(16, 'b');
  CHECK(difference(one, other) == "'case a: scene' has changed");
  other = one;
  other.pop_back();
  CHECK(difference(one, other) == "'case a: x' is new");
  CHECK(difference(other, one) == "'case a: x' is gone");
}
