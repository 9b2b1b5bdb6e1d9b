// SPDX-License-Identifier: Apache-2.0
// A scan of two hundred labels.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// Small balls in a trunk of fat: ribs, vertebrae and organs with known names, and as many with unknown ones.
std::vector<ScannedOrgan> twoHundredOrgans() {
  std::vector<std::string> names{"liver",       "spleen",       "pancreas", "stomach",
                                 "kidney_left", "kidney_right", "colon",    "aorta"};
  for (int i = 1; i <= 12; ++i)
    for (const char *side : {"rib_left_", "rib_right_", "vertebrae_T"}) names.push_back(side + std::to_string(i));
  for (int i = 1; names.size() < 200; ++i) names.push_back("finding_of_the_second_reader_" + std::to_string(i));
  std::vector<ScannedOrgan> organs;
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto at = [n](std::size_t stride, std::size_t count, double step) {
      return step * (static_cast<double>(n / stride % count) - 0.5 * static_cast<double>(count - 1));
    };
    const auto part = [n](std::size_t k) { return 0.2f + 0.1f * static_cast<float>(n / k % 8); };
    organs.push_back({names[n],
                      {at(1, 8, 22), at(8, 5, 20), at(40, 5, 19)},
                      {9, 9, 9},
                      40 + static_cast<int>(n),
                      {part(1), part(3), part(7)}});
  }
  return organs;
}

}  // namespace

TEST_CASE("A scan of two hundred labels is chosen from, made alive and read as quickly as one of three",
          "[many_labels]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("many_labels");
  openDialog(window, writeScan("many_labels", twoHundredOrgans()));
  CHECK_THAT(window.value("scan/count"), Contains("200 of 200 labels, 156 not known"));
  // All entries that a filter lists at once, a single one differently, one at the end of the list, and back.
  typeInto(window, "filter", "not known");
  C3DE_WAIT(window, "they are listed", textOf(s, "scan/count").find("156 of 200") == 0);
  const std::string finding = "finding_of_the_second_reader_";
  window.choose("scan/use_listed", "fat");
  window.waitForValue("scan/use." + finding + "7", "fat");
  chooseTissue(window, finding + "7", "breast_gland");
  CHECK(window.value("scan/use." + finding + "156") == "fat");
  window.screenshotAtRest("chosen");
  window.click("scan/undo");
  window.waitForValue("scan/use." + finding + "7", "fat");
  window.click("scan/undo");
  window.waitForValue("scan/use." + finding + "7", "background");
  const Json undone = window.state();
  CHECK(std::find(undone["disabled"].begin(), undone["disabled"].end(), "scan/undo") != undone["disabled"].end());
  typeInto(window, "filter", "");
  C3DE_WAIT(window, "all are listed", textOf(s, "scan/count").find("200 of 200") == 0);
  chooseTissue(window, finding + "156", "muscle_skeletal_rest");
  window.screenshotAtRest("end_of_list");
  setPoints(window, "800");
  (void)createBody(window);

  // The table, closed and open: the cost of a frame while the mouse moves over the 3D view and the simulation is
  // paused.
  window.moveTo(window.inView(0.9, 0.9));
  pause(window);
  const auto frame_ms = [&] {
    window.waitFrames(5, 0.3);
    const Json before = window.state();
    for (int i = 0; i < 40; ++i) window.moveTo(window.inView(0.8 + 0.003 * (i % 30), 0.9));
    const Json after = window.state();
    const double frames = after["frame"].get<double>() - before["frame"].get<double>();
    REQUIRE(frames > 20);
    return 1e3 * (after["processor_s"].get<double>() - before["processor_s"].get<double>()) / frames;
  };
  const double closed_ms = frame_ms();
  window.click("tissues/header");
  C3DE_WAIT(window, "labels are followed",
            std::isfinite(numberOf(s, "tissues/" + finding + "156.det_f")) &&
                std::isfinite(numberOf(s, "tissues/liver.mean")));
  CHECK(window.value("tissues/count") == "201 of 201 labels");
  const double open_ms = frame_ms();
  CAPTURE(closed_ms, open_ms);
  // 11.5 and 13 seen, most of it software OpenGL; writing the state for this test is included.
  CHECK(open_ms < 3.0 * closed_ms);  // Within one run.

  // Pulled, and read: the largest displacement comes first, the filter works, the last row can be reached, the file has
  // all.
  takePinch(window);
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  window.click("tissues/order.largest");
  pull(window, window.inSlice("axial", -55, -40), window.inSlice("axial", -55, -60));
  const Json pulled =
      C3DE_WAIT(window, "something has moved", numberOf(s, "tissues/" + textOf(s, "tissues/first") + ".largest") > 4.0);
  const double most = numberOf(pulled, "tissues/" + textOf(pulled, "tissues/first") + ".largest");
  for (const auto &[key, text] : pulled["values"].items())
    if (key.starts_with("tissues/") && key.ends_with(".largest")) CHECK(numberOf(pulled, key) <= most);
  window.screenshot("pulled");
  window.moveTo(window.inSlice("axial", -55, -60));
  window.release();
  pause(window);
  const auto motions = exportTissues(window, "many_labels");
  CHECK(motions.size() == 201);
  CHECK(motions.contains("rib_right_12"));
  window.click("tissues/order.label");
  window.waitForValue("tissues/first", "liver");
  window.moveTo(window.locate("tissues/pancreas"));
  for (int i = 0; i < 40 && !window.has("tissues/background"); ++i) {
    window.wheel(-5);
    window.waitFrames(2, 0.3);
  }
  CHECK(window.has("tissues/background"));
  CHECK_FALSE(window.has("tissues/pancreas"));
  window.screenshotAtRest("last_row");
  window.click("tissues/filter");
  window.type("vertebrae");
  window.waitForValue("tissues/count", "12 of 201 labels");
  window.screenshot("filtered");
}
