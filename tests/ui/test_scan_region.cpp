// SPDX-License-Identifier: Apache-2.0
// A region of a scan, drawn as a box in its slices.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// Corners of a box: "x y z x y z", mm.
using Box = std::array<double, 6>;
Box boxOf(const std::string &text) {
  Box box{};
  std::istringstream in(text);
  for (double &number : box) in >> number;
  return box;
}
Box drawnBox(const WorkstationDriver &window) { return boxOf(window.value("region/box")); }
Box chosenBox(const WorkstationDriver &window) {
  std::string text;
  for (const char *end : {"from", "to"})
    for (const char *axis : {"x", "y", "z"}) text += window.value(std::string("scan/region.") + axis + "." + end) + " ";
  return boxOf(text);
}
bool isNear(const Box &a, const Box &b, double tolerance) {
  return std::equal(a.begin(), a.end(), b.begin(), [&](double p, double q) { return std::abs(p - q) <= tolerance; });
}

void waitForDrawn(WorkstationDriver &window, const Box &box, double tolerance) {
  C3DE_WAIT(window, "the box is there that was drawn", isNear(boxOf(textOf(s, "region/box")), box, tolerance));
}

/// Of the skins at their current positions.
Box exportedBounds(WorkstationDriver &window, const std::string &name) {
  Box bounds{1e9, 1e9, 1e9, -1e9, -1e9, -1e9};
  std::ifstream in(exported(window, "export_surface", name + ".obj"));
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("v ")) continue;
    std::istringstream numbers(line.substr(2));
    for (std::size_t a = 0; a < 3; ++a) {
      double at = 0.0;
      numbers >> at;
      bounds[a] = std::min(bounds[a], at);
      bounds[3 + a] = std::max(bounds[3 + a], at);
    }
  }
  return bounds;
}

}  // namespace

TEST_CASE("A region is drawn as a box in the slices, and the body is what of the scan lies in it", "[scan_region]") {
  C3DE_ORGAN_OR_SKIP();
  constexpr double kVoxel_mm = 4.0;
  constexpr Box kWhole{-128, -96, -60, 128, 96, 60};
  WorkstationDriver window("scan_region");
  openDialog(window, writeScan("scan_region", threeOrgans(), kVoxel_mm));
  CHECK(window.value("scan/unit") == "HU");
  chooseTissue(window, "kidney_left", "spleen");
  window.key("ctrl+z");
  window.waitForValue("scan/use.kidney_left", "kidney_cortex");
  setPoints(window, "800");

  // It begins with the whole scan.
  const auto draw = [&] {
    window.click("scan/draw_region");
    return C3DE_WAIT(window, "the slices are to be drawn in",
                     s["widgets"].contains("region/done") && s["widgets"].contains("region/axial.left") &&
                         !s["widgets"].contains("scan/make"));
  };
  (void)draw();
  waitForDrawn(window, kWhole, 1e-6);
  window.screenshotAtRest("whole");

  // A rectangle in the axial slice, undone and drawn again; top and bottom by their handles in the coronal one.
  window.drag(window.inSlice("axial", -80, -60), window.inSlice("axial", 60, 50), 5);
  const Box inOne{-80, -60, -60, 60, 50, 60};
  waitForDrawn(window, inOne, kVoxel_mm);
  window.key("ctrl+z");
  waitForDrawn(window, kWhole, 1e-6);
  window.key("ctrl+y");
  waitForDrawn(window, inOne, kVoxel_mm);
  window.drag(window.locate("region/coronal.top"), window.inSlice("coronal", 0, -24), 5);
  window.drag(window.locate("region/coronal.bottom"), window.inSlice("coronal", 20, 36), 5);
  const Box wanted{-80, -60, -36, 60, 50, 24};
  waitForDrawn(window, wanted, kVoxel_mm);
  CHECK_THAT(window.value("region/size"), Contains(" mm"));
  CHECK(std::abs(window.number("region/volume") - 924.0) < 100.0);
  window.screenshotAtRest("drawn");

  // The cursor indicates the action; Escape cancels a drag, and only that.
  window.moveTo(window.locate("region/axial.top_left"));
  window.waitForValue("region/axial.grip", "side");
  window.screenshot("corner");
  window.moveTo(window.inSlice("axial", 20, 20));
  window.waitForValue("region/axial.grip", "move");
  window.moveTo(window.inSlice("axial", 100, 20));
  window.waitForValue("region/axial.grip", "draw");
  const Box before = drawnBox(window);
  pull(window, window.locate("region/sagittal.left"), window.inSlice("sagittal", 0, 0));
  C3DE_WAIT(window, "it is dragged", boxOf(textOf(s, "region/box"))[1] > before[1] + 40);
  window.key("Escape");
  waitForDrawn(window, before, 1e-6);
  window.moveTo(window.inSlice("sagittal", 10, 0));
  window.release();
  waitForDrawn(window, before, 1e-6);
  CHECK(window.has("region/done"));

  // Outside the box it is dashed; the wheel scrolls the slices as always.
  const int slice = std::atoi(window.value("image/axial.slice").c_str());
  window.moveTo(window.inSlice("axial", 20, 20));
  window.wheel(10);
  window.waitForValue("image/axial.slice", std::to_string(slice + 10));
  window.waitForValue("region/axial.is_cut", "false");
  window.screenshotAtRest("beside");
  window.wheel(-10);
  window.waitForValue("region/axial.is_cut", "true");

  // Enter: applied to the dialog.
  window.key("Return");
  const auto isBack = [](const Json &s) {
    return s["widgets"].contains("scan/make") && !s["widgets"].contains("region/done");
  };
  window.waitUntil("the dialog is back", isBack);
  CHECK(window.value("scan/region") == "true");
  CHECK(isNear(chosenBox(window), before, 1e-3));
  window.screenshotAtRest("back");

  // Moved, and cancelled by key and by button: the previous region is restored.
  for (const bool isKey : {true, false}) {
    (void)draw();
    waitForDrawn(window, before, 1e-6);
    window.drag(window.inSlice("axial", -40, 0), window.inSlice("axial", -20, 20), 4);
    waitForDrawn(window, {-60, -40, -36, 80, 70, 24}, kVoxel_mm);
    window.click("region/whole");
    waitForDrawn(window, kWhole, 1e-6);
    if (isKey)
      window.key("Escape");
    else
      window.click("region/cancel");
    window.waitUntil("the dialog is back", isBack);
    CHECK(isNear(chosenBox(window), before, 1e-3));
  }

  (void)createBody(window);
  const Box body = exportedBounds(window, "scan_region");
  CAPTURE(body[0], body[1], body[2], body[3], body[4], body[5]);
  for (std::size_t a = 0; a < 3; ++a) {
    CHECK(body[a] > before[a] - 0.5 * kVoxel_mm);
    CHECK(body[3 + a] < before[3 + a] + 0.5 * kVoxel_mm);
  }
  CHECK(isNear(body, before, 1.5 * kVoxel_mm));  // there is fat in each direction
  window.screenshot("alive");
}

TEST_CASE("While a region is drawn the scan lies at rest, and menus, keys and tools do what they say",
          "[scan_region_alive]") {
  C3DE_ORGAN_OR_SKIP();
  constexpr double kVoxel_mm = 4.0;
  WorkstationDriver window("scan_region_alive");
  openDialog(window, writeScan("scan_region_alive", threeOrgans(), kVoxel_mm));
  setPoints(window, "300");
  (void)createBody(window);
  takePinch(window);
  pull(window, window.inSlice("axial", -45, -10), window.inSlice("axial", -45, -40));
  C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 8.0));
  window.key("space");
  const auto waitForMode = [&](const std::string &mode) {
    C3DE_WAIT(window, "it is " + mode, s["transport"]["mode"] == mode);
  };
  waitForMode("paused");
  window.release();
  window.screenshotAtRest("pulled");

  // Besides the button of the panel there is the menu, for opening and for going back.
  const auto isAsked = [](const Json &s) {
    return s["widgets"].contains("scan/make") && !s["widgets"].contains("region/done");
  };
  const auto isDrawn = [](const Json &s) {
    return s["widgets"].contains("region/done") && s["widgets"].contains("region/axial.left") &&
           !s["widgets"].contains("scan/make") && !s["widgets"].contains("dialog/path");
  };
  const auto chooseFile = [&](const std::string &item) { window.clickMenu("file." + item); };
  const auto isAtRest = [](const Json &s) {
    return textOf(s, "region/note").find("shown undeformed") != std::string::npos &&
           textOf(s, "image/axial.readout").find("|u|") == std::string::npos &&
           !s["values"].contains("image/axial.outlines");
  };
  Box drawn{-128, -96, -60, 128, 96, 60};
  for (const bool isMenu : {true, false}) {
    if (isMenu)
      chooseFile("create_scan_body");
    else
      window.waitUntil("it is asked", isAsked);
    window.waitUntil("it is asked", isAsked);
    window.click("scan/draw_region");
    window.waitUntil("it is drawn", isDrawn);
    waitForDrawn(window, drawn, 1e-3);
    window.moveTo(window.inSlice("axial", -45, -30));
    window.waitUntil("the scan is at rest", isAtRest);
    window.screenshotAtRest(isMenu ? "at_rest" : "at_rest_again");
    const double left = isMenu ? -80 : -60;
    window.drag(isMenu ? window.inSlice("axial", -80, -60) : window.locate("region/axial.left"),
                isMenu ? window.inSlice("axial", 60, 50) : window.inSlice("axial", left, 0), 5);
    drawn = {left, -60, -60, 60, 50, 60};
    waitForDrawn(window, drawn, kVoxel_mm);
    drawn = drawnBox(window);
    if (isMenu)
      chooseFile("create_scan_body");
    else
      window.click("segmentation/create_scan_body");
    window.waitUntil("the dialog is back", isAsked);
    CHECK(window.value("scan/region") == "true");
    CHECK(isNear(chosenBox(window), drawn, 1e-3));
  }

  // A dialog opened above it receives its keys; the simulation plays below it; the tool keeps the 3D view.
  window.click("scan/draw_region");
  window.waitUntil("it is drawn", isDrawn);
  window.moveTo(window.inSlice("axial", 0, 0));
  for (const char *key : {"ctrl+o", "F1"}) {
    window.key(key);
    C3DE_WAIT(window, "a dialog is above",
              s["widgets"].contains("dialog/path") || s["widgets"].contains("dialog/close"));
    window.key("Return");
    window.key("Escape");
    window.waitUntil("it is drawn", isDrawn);
  }
  window.key("space");
  waitForMode("playing");
  window.waitUntil("the scan is at rest", isAtRest);
  window.key("space");
  waitForMode("paused");
  window.key("space");
  pull(window, window.inView(0.5, 0.5), window.inView(0.6, 0.4));
  C3DE_WAIT(window, "the pinch pulls", numberOf(s, kPanel + "Pinch force") > 0.0);
  window.key("Escape");
  C3DE_WAIT(window, "it lets go", textOf(s, kPanel + "Pinch force") == "–");
  window.release();
  window.key("space");
  waitForMode("paused");
  window.waitUntil("it is drawn", isDrawn);
  waitForDrawn(window, drawn, 1e-3);
  window.screenshotAtRest("above");
  window.key("Escape");
  window.waitUntil("the dialog is back", isAsked);
  CHECK(isNear(chosenBox(window), drawn, 1e-3));

  // Without an image there is nothing to draw in.
  window.click("scan/draw_region");
  window.waitUntil("it is drawn", isDrawn);
  chooseFile("close_image");
  C3DE_WAIT(window, "all is gone",
            s["panes"].size() < 4 && !s["widgets"].contains("region/done") && !s["widgets"].contains("scan/make"));
  window.screenshotAtRest("closed");
}
