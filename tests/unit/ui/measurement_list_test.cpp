// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/measurement_list.h"

#include <cmath>

#include "c3de/registry/edit_list.h"
#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

MeasurementSet triangle() {
  MeasurementSet set;
  set.points = {{"a", {}, {0, 0, 0}, Vec3{0, 0, 1}, false, false},
                {"b", {}, {30, 0, 0}, Vec3{30, 0, 3}, false, false},
                {"c", {}, {0, 40, 0}, {}, false, false}};
  set.measures = {{"width", {"a", "b"}, false, false}, {"corner", {"b", "a", "c"}, false, false}};
  return set;
}

}  // namespace

TEST_CASE("Measurements have one number at rest and two after a motion") {
  MeasurementList list;
  list.edit("add", triangle());
  CHECK(list.row("width")->label() == "30.0 mm");
  CHECK(list.row("corner")->label() == "90.0°");
  CHECK(list.row("a")->label().empty());
  CHECK_FALSE(list.hasMoved());
  list.addPositions({{"a", {0, 0, 0}}, {"b", {20, 0, 0}}, {"c", {40, 40, 0}}}, 0.5);
  CHECK(list.row("width")->label() == "30.0 → 20.0 mm");
  CHECK(list.row("width")->changeText() == "-10.0");
  CHECK(list.row("corner")->label() == "90.0 → 45.0°");
  CHECK(list.row("b")->label() == "10.0 mm");
  CHECK(list.hasMoved());
}

TEST_CASE("Errors to targets are those at rest and now") {
  MeasurementList list;
  list.edit("add", triangle());
  list.addPositions({{"a", {0, 0, 1}}, {"b", {30, 0, 1}}}, 0.0);
  const auto errors = list.targetErrors();
  REQUIRE(errors);
  CHECK(errors->count == 2);
  CHECK_THAT(errors->mean_mm[0], WithinAbs(2.0, 1e-12));
  CHECK_THAT(errors->sd_mm[0], WithinAbs(std::sqrt(2.0), 1e-12));
  CHECK_THAT(errors->max_mm[0], WithinAbs(3.0, 1e-12));
  CHECK_THAT(errors->mean_mm[1], WithinAbs(1.0, 1e-12));
  CHECK_THAT(errors->max_mm[1], WithinAbs(2.0, 1e-12));
}

TEST_CASE("Every edit of measurements is undone and redone, and the revision returns") {
  registry::EditList edits;
  MeasurementList list(&edits);
  list.edit("add", triangle());
  const std::uint64_t first = list.revision();
  MeasurementSet set = list.set();
  set.remove("a");
  CHECK(set.measures.empty());
  CHECK(set.points.size() == 2);
  list.edit("delete a", set);
  CHECK(edits.undoLabel() == "delete a");
  edits.undo();
  CHECK(list.set() == triangle());
  CHECK(list.revision() == first);
  edits.redo();
  CHECK(list.set() == set);
  CHECK(list.revision() != first);
  edits.undo();
  edits.undo();
  CHECK(list.set().isEmpty());
  CHECK(list.revision() == 0);
}

TEST_CASE("A name that is used or empty is refused, and measures follow a new name") {
  MeasurementSet set = triangle();
  CHECK_FALSE(set.rename("a", "width"));
  CHECK_FALSE(set.rename("a", ""));
  CHECK(set == triangle());
  REQUIRE(set.rename("a", "apex"));
  CHECK(set.measure("width")->points == std::vector<std::string>{"apex", "b"});
  CHECK(set.freeName("Landmark") == "Landmark 1");
}

TEST_CASE("A scene that is read again replaces its own measurements and keeps those of the user") {
  MeasurementSet set = triangle();
  set.points[2].isOfScene = true;
  set.measures[1].isOfScene = true;
  MeasurementSet scene;
  scene.points = {{"b", {}, {1, 1, 1}, {}, false, true}, {"d", {}, {2, 2, 2}, {}, false, true}};
  set.mergeScene(scene);
  REQUIRE(set.points.size() == 3);
  CHECK(set.point("b")->reference_mm == Vec3{1, 1, 1});
  CHECK(set.point("a"));
  CHECK_FALSE(set.point("c"));
  CHECK(set.measure("width"));
  CHECK_FALSE(set.measure("corner"));
}

TEST_CASE("Curves are bounded, and a reset discards what came after it") {
  MeasurementList list;
  list.edit("add", triangle());
  constexpr int kSamples = 5000;
  for (int i = 0; i < kSamples; ++i) list.addPositions({{"a", {0, 0, 0}}, {"b", {30.0 + i, 0, 0}}}, 0.01 * i);
  CHECK(list.sampleCount() < MeasurementList::kMostSamples);
  const auto curve = list.curve("width");
  REQUIRE(curve.size() == list.sampleCount());
  CHECK_THAT(curve.front().value, WithinAbs(30.0, 1e-12));
  CHECK_THAT(curve.back().value, WithinAbs(30.0 + kSamples - 1, 1e-9));
  for (const auto &p : curve) CHECK_THAT(p.value - 30.0, WithinAbs(100.0 * p.time_s, 1e-6));
  // The past is as dense as what came later.
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    const double gap_s = curve[i].time_s - curve[i - 1].time_s;
    CHECK((gap_s > 0.039 && gap_s < 0.081));
  }
  list.addPositions({{"a", {0, 0, 0}}, {"b", {30, 0, 0}}}, 0.0);
  CHECK(list.sampleCount() == 1);
  list.addPositions({{"a", {0, 0, 0}}, {"b", {31, 0, 0}}}, 0.5);
  // c is not followed: its displacement, and the angle with it, have no value.
  CHECK(list.curvesCsv() ==
        "time [s],a displacement [mm],b displacement [mm],c displacement [mm],width [mm],corner [degrees]\n"
        "0,0,0,,30,\n0.5,0,1,,31,\n");
  CHECK(list.row("width")->label() == "30.0 → 31.0 mm");
  list.setUnits({DisplayUnits::Length::cm, {}, {}});
  CHECK(list.row("width")->label() == "3.00 → 3.10 cm");
  CHECK(list.row("width")->changeText() == "+0.10");
  CHECK(list.curvesCsv() ==
        "time [s],a displacement [cm],b displacement [cm],c displacement [cm],width [cm],corner [degrees]\n"
        "0,0,0,,3,\n0.5,0,0.1,,3.1,\n");
  CHECK_THAT(list.tableCsv(), Contains("width,distance,cm,3,3.1,0.1,") && Contains("error now [cm]"));
}
