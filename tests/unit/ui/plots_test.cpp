// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/plots.h"

#include <cmath>
#include <string>

#include "support/catch.h"

using namespace c3de;
using namespace c3de::ui;

namespace {

PlotValue force(double value) { return {"force", "finger, force", "N", value, true, {}, {}}; }

}  // namespace

TEST_CASE("A curve has the values of the moments that were added, and the present one is that before a time") {
  PlotList plots;
  plots.add(0.0, {force(1.0)});
  plots.add(0.5, {force(2.0)});
  plots.add(0.5, {force(3.0)});  // the same moment again
  REQUIRE(plots.series().size() == 1);
  const PlotList::Series &series = plots.series().front();
  CHECK(series.isShown);
  REQUIRE(series.points.size() == 2);
  CHECK(series.points.back().value == 3.0);
  CHECK(series.valueAt(0.49) == 1.0);
  CHECK(series.valueAt(9.0) == 3.0);
  CHECK(!series.valueAt(-0.1).has_value());
}

TEST_CASE("Going back in time discards what came after, in curves without a new value as well") {
  PlotList plots;
  plots.add(0.0, {force(1.0), {"gone", "gone", "mm", 7.0}});
  plots.add(1.0, {force(2.0), {"gone", "gone", "mm", 8.0}});
  plots.add(0.5, {force(5.0)});
  CHECK(plots.series()[0].points.size() == 2);
  CHECK(plots.series()[0].points.back().value == 5.0);
  CHECK(plots.series()[1].points.size() == 1);
  CHECK(plots.series()[1].points.back().value == 7.0);
}

TEST_CASE("Sources with times of their own do not shorten each other's curves") {
  PlotList plots;
  plots.add(1.0, {force(1.0)}, 0);
  plots.add(0.9, {{"length", "length", "mm", 2.0}}, 1);
  plots.add(1.1, {{"length", "length", "mm", 3.0}}, 1);
  plots.add(1.05, {force(2.0)}, 0);
  CHECK(plots.series()[0].points.size() == 2);
  CHECK(plots.series()[1].points.size() == 2);
  plots.keepOnly(1, {});
  REQUIRE(plots.series().size() == 1);
  CHECK(plots.series()[0].last.id == "force");
}

TEST_CASE("Memory of curves is bounded, and they still span all the time") {
  PlotList plots;
  for (int i = 0; i < 50000; ++i) plots.add(1e-3 * i, {force(i)});
  const std::vector<PlotPoint> &points = plots.series().front().points;
  CHECK(points.size() <= PlotList::kMaxPoints);
  CHECK(points.size() > PlotList::kMaxPoints / 4);
  CHECK(points.front().time_s < 0.1);
  CHECK(points.back().value == 49999.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    REQUIRE(points[i - 1].time_s < points[i].time_s);
    REQUIRE(points[i].time_s - points[i - 1].time_s < 0.15);  // evenly over 50 s
  }
  for (int i = 0; i < 1000; ++i) plots.add(60.0, {{"s" + std::to_string(i), "", "", 1.0}});
  CHECK(plots.series().size() == PlotList::kMaxSeries);
}

TEST_CASE("Curves of scenes that were closed leave room for those of others, and choices are kept") {
  PlotList plots;
  for (std::size_t scene = 0; scene < 3; ++scene) {
    for (std::size_t i = 0; i < PlotList::kMaxSeries; ++i)
      plots.add(0.0, {{std::to_string(scene) + "." + std::to_string(i), "", "", 1.0}});
    CHECK(plots.series().size() == PlotList::kMaxSeries);
    CHECK(plots.series().front().last.id == std::to_string(scene) + ".0");
    plots.show("0.0", true);
    plots.clear();
    CHECK(plots.series().empty());
  }
  plots.add(0.0, {{"0.0", "", "", 1.0}});
  CHECK(plots.shownCount() == 1);
}

TEST_CASE("Curves without points make room for others") {
  PlotList plots;
  for (std::size_t i = 0; i < PlotList::kMaxSeries; ++i) plots.add(1.0, {{std::to_string(i), "", "", 1.0}});
  plots.add(0.0, {force(1.0)});
  REQUIRE(plots.series().size() == 1);
  CHECK(plots.series().front().last.id == "force");
}

TEST_CASE("What is not finite is no point of a curve") {
  PlotList plots;
  plots.add(0.0, {force(std::nan(""))});
  plots.add(std::nan(""), {force(1.0)});
  CHECK(plots.series().empty());
}

TEST_CASE("The past of a curve is taken over once") {
  PlotList plots;
  plots.addPast(force(0.0), {{0.0, 1.0}, {0.1, 2.0}});
  plots.addPast(force(0.0), {{0.0, 9.0}});
  plots.add(0.2, {force(3.0)});
  REQUIRE(plots.series().front().points.size() == 3);
  CHECK(plots.series().front().points.front().value == 1.0);
}

TEST_CASE("The table has the shown curves, with units, quotes and empty cells") {
  PlotList plots;
  plots.add(0.0, {force(1.5)});
  plots.add(0.25, {{"length", "length", "mm", 42.0, true, {}, {}}, {"hidden", "hidden", "J", 1.0}});
  CHECK(plots.shownCount() == 2);
  CHECK(plots.csv() == "time [s],\"finger, force [N]\",length [mm]\n0,1.5,\n0.25,,42\n");
  plots.show("force", false);
  CHECK(plots.csv() == "time [s],length [mm]\n0.25,42\n");
  plots.show("force", true);
  plots.setUnits({DisplayUnits::Length::cm, DisplayUnits::Pressure::kPa, DisplayUnits::Force::mN});
  CHECK(plots.csv() == "time [s],\"finger, force [mN]\",length [cm]\n0,1500,\n0.25,,4.2\n");
  plots.add(0.5, {force(2.0)});
  CHECK(plots.series().front().last.value == 2000.0);
  plots.setUnits({});
  CHECK(plots.csv() == "time [s],\"finger, force [N]\",length [mm]\n0,1.5,\n0.25,,42\n0.5,2,\n");
  plots.show("force", false);
  plots.clear();
  CHECK(plots.csv() == "time [s]\n");
  plots.add(0.0, {force(1.0)});
  CHECK(plots.shownCount() == 0);  // it is still not chosen
}
