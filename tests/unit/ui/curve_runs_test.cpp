// SPDX-License-Identifier: Apache-2.0
// Outlines in slices: thick lines along a curve end at its corners, where their mitres would be spikes.
#include "logic/curve_runs.h"

#include <cmath>

#include "support/catch.h"

using c3de::ui::CurvePoint;
using c3de::ui::curveRuns;

TEST_CASE("A smooth closed curve is one closed run", "[curve_runs]") {
  std::vector<CurvePoint> circle;
  for (int i = 0; i < 24; ++i)
    circle.push_back(
        {20.0f * std::cos(0.2618f * static_cast<float>(i)), 20.0f * std::sin(0.2618f * static_cast<float>(i))});
  const auto runs = curveRuns(circle, true);
  REQUIRE(runs.size() == 1);
  CHECK(runs[0].isClosed);
  CHECK(runs[0].points.size() == 24);
}

TEST_CASE("A sliver ends at its tips, and its runs together are the whole of it", "[curve_runs]") {
  const std::vector<CurvePoint> sliver{{10, 1}, {20, 0}, {10, -1}, {0, 0}};
  const auto runs = curveRuns(sliver, true);
  REQUIRE(runs.size() == 2);
  for (const auto &run : runs) {
    CHECK_FALSE(run.isClosed);
    CHECK(run.points.size() == 3);
  }
  CHECK(runs[0].points.front().x == 20.0f);
  CHECK(runs[0].points.back().x == 0.0f);
  CHECK(runs[1].points.front().x == 0.0f);
  CHECK(runs[1].points.back().x == 20.0f);

  const auto open = curveRuns({{0, 0}, {10, 0}, {20, 0}, {20, 10}, {20, 20}}, false);
  REQUIRE(open.size() == 2);
  CHECK(open[0].points.size() == 3);
  CHECK(open[1].points.size() == 3);
}

TEST_CASE("Steps below half a pixel turn no line aside, and a point is still seen", "[curve_runs]") {
  const auto runs = curveRuns({{0, 0}, {10, 0}, {10.0f, 0.01f}, {9.99f, 0.0f}, {20, 0}}, false);
  REQUIRE(runs.size() == 1);
  CHECK(runs[0].points.size() == 3);
  const auto dot = curveRuns({{5, 5}, {5.1f, 5}, {5, 5.1f}}, true);
  REQUIRE(dot.size() == 1);
  CHECK(dot[0].points.size() == 2);
  CHECK(curveRuns({}, true).empty());
}
