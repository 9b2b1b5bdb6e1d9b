// SPDX-License-Identifier: Apache-2.0
// Fields of pulled tissue, and cells that follow where it is pulled.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// Of a legend: "|u| 0 … 5 mm".
std::array<double, 2> rangeOf(const std::string &legend, const std::string &title) {
  return {numberAfter(legend, title + " "), numberAfter(legend, "… ")};
}

}  // namespace

TEST_CASE("Cells become finer where a hand has pulled, for as many points", "[scan_finer]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("scan_finer");
  (void)createBodyFromScan(window, "scan_finer", "1200");
  const double phyxels = numberOf(window.state(), kPanel + "Phyxels"),
               spacing = numberOf(window.state(), kPanel + "Spacing");
  REQUIRE(phyxels > 900);
  CHECK_FALSE(window.state()["values"].contains(kPanel + "Halved cells"));

  takePinch(window);
  pull(window, window.inSlice("axial", -60, -20), window.inSlice("axial", -62, -45));
  C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 4.0));
  window.release();
  window.screenshot("pulled");
  window.click(kPanel + "finer");
  const Json finer =
      C3DE_WAIT(window, "the body is sampled anew", s["jobs"].empty() && s["values"].contains(kPanel + "Halved cells"));
  CHECK(numberOf(finer, kPanel + "Halved cells") > 0);
  CHECK(std::abs(numberOf(finer, kPanel + "Phyxels") - phyxels) < 0.15 * phyxels);
  CHECK(numberOf(finer, kPanel + "Spacing") > 1.05 * spacing);
  C3DE_WAIT(window, "it has begun anew", !isOver(s, "axial", 0.5));
  window.screenshot("finer");
  // It can be pulled as before.
  window.moveTo(window.inView(0.5, 0.5));
  if (window.state()["transport"]["mode"] != "playing") window.key("space");
  pull(window, window.inSlice("axial", -60, -20), window.inSlice("axial", -62, -45));
  C3DE_WAIT(window, "the scan follows again", isOver(s, "axial", 4.0));
  window.screenshot("pulled_finer");
  window.release();
}

TEST_CASE("Fields of tissue that is pulled are in the slices, under the mouse and in the table of labels",
          "[scan_fields]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("scan_fields");
  (void)createBodyFromScan(window, "scan_fields", "800");

  window.click("tissues/header");
  const auto isFollowed = [](const Json &s) { return std::isfinite(numberOf(s, "tissues/liver.det_f")); };
  const Json resting = window.waitUntil("labels are followed", isFollowed);
  CHECK(textOf(resting, "tissues/count") == "4 of 4 labels");
  CHECK(std::abs(numberOf(resting, "tissues/liver.volume") - 305.6) < 10.0);
  CHECK(numberOf(resting, "tissues/liver.largest") < 0.5);
  CHECK(numberOf(resting, "tissues/vertebrae_L1.largest") == 0.0);
  window.click("tissues/filter");
  window.type("kidney");
  window.waitForValue("tissues/count", "1 of 4 labels");
  CHECK_FALSE(window.has("tissues/liver"));
  window.key("ctrl+a");
  window.key("BackSpace");
  window.key("Return");  // keys are the window's again
  window.waitForValue("tissues/count", "4 of 4 labels");

  takePinch(window);
  const Point from = window.inSlice("axial", -60, -20), to = window.inSlice("axial", -62, -45);
  pull(window, from, to);
  // With the mouse over tissue, and over none.
  window.waitUntil("tissue under the mouse is told", [](const Json &s) {
    const std::string readout = textOf(s, "image/axial.readout");
    return isOver(s, "axial", 4.0) && std::abs(numberAfter(readout, "det F ") - 1.0) > 0.001 &&
           numberAfter(readout, "equivalent stress ") > 0.05 && readout.find(" kPa") != std::string::npos;
  });
  const Json pulled =
      C3DE_WAIT(window, "the table has followed",
                numberOf(s, "tissues/liver.largest") > 4.0 && numberOf(s, "tissues/liver.det_f") < 0.99);
  CHECK(numberOf(pulled, "tissues/liver.mean") < numberOf(pulled, "tissues/liver.largest"));
  CHECK(numberOf(pulled, "tissues/kidney_left.largest") < 0.5 * numberOf(pulled, "tissues/liver.largest"));
  CHECK(numberOf(pulled, "tissues/vertebrae_L1.largest") == 0.0);
  window.screenshot("pulled");
  window.release();
  window.moveTo(window.inView(0.5, 0.5));
  pause(window);

  // Also when paused: the request is answered at once.
  window.screenshotAtRest("plain");
  CHECK(textOf(window.state(), "image/axial.legend") == "none");
  const auto show = [&](const std::string &overlay, const std::string &unit) {
    window.choose("image/overlay", overlay);
    const Json shown =
        C3DE_WAIT(window, "it is in the legend", textOf(s, "image/axial.legend").find(overlay + " ") == 0);
    INFO(textOf(shown, "image/axial.legend"));
    CHECK(textOf(shown, "image/axial.legend").ends_with(" " + unit));
    window.moveTo(window.inView(0.5, 0.5));
    return rangeOf(textOf(shown, "image/axial.legend"), overlay);
  };
  const auto change = show("volume change", "%");
  CHECK(change[1] > 0.5);
  CHECK(change[0] == -change[1]);
  window.screenshotAtRest("change");
  CHECK(window.differsFrom("plain", "change", 2000, "axial"));
  const auto stress = show("equivalent stress", "kPa");
  CHECK(stress[0] == 0.0);
  CHECK(stress[1] > 0.02);
  window.screenshotAtRest("stress");
  CHECK(window.differsFrom("change", "stress", 2000, "axial"));
  CHECK(show("|u|", "mm")[1] > 3.0);
  window.click("image/overlay_fixed");
  window.waitForValue("image/overlay_fixed", "true");
  window.enterNumber("image/overlay_high", "20");
  window.waitForValue("image/axial.legend", "|u| 0 … 20 mm");
  // Outside the body there is no field; inside there is.
  window.moveTo(window.inSlice("axial", -60, -20));
  C3DE_WAIT(window, "tissue is told while it stands",
            textOf(s, "image/axial.readout").find("det F ") != std::string::npos);
  window.moveTo(window.inSlice("axial", -120, -80));
  window.waitUntil("nothing is told beside the body", [](const Json &s) {
    const std::string readout = textOf(s, "image/axial.readout");
    return readout.find("|u| ") != std::string::npos && readout.find("det F") == std::string::npos &&
           readout.find("stress") == std::string::npos;
  });

  const fs::path table = outputFile("scan_fields.csv");
  fs::remove(table);
  window.click("tissues/export");
  window.openFile(table);
  C3DE_WAIT(window, "it is written", s["jobs"].empty() && fs::exists(table));
  std::ifstream file(table);
  std::string first, liver;
  std::getline(file, first);
  for (std::string line; std::getline(file, line);)
    if (line.find(",liver,") != std::string::npos) liver = line;
  CHECK(first ==
        "body,label,name,tissue,material,rigid,voxels,volume [m3],volume at the end [m3],mean displacement [m],largest "
        "displacement [m],min J");
  const double largest_mm = 1e3 * numberAfter(liver, ",", 10);
  // The table of the window uses a coarser grid, and shows one digit.
  const double shown_mm = numberOf(window.state(), "tissues/liver.largest");
  CHECK(std::abs(largest_mm - shown_mm) < 0.05 + 0.1 * largest_mm);
}
