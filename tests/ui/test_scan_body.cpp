// SPDX-License-Identifier: Apache-2.0
// From a scan and its labels to one body of all labelled tissues, by mouse.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "c3de/imaging/reading.h"
#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

TEST_CASE("A scan becomes one body of all its labels, and is pulled where a slice shows it", "[scan_alive]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("scan_alive");
  openDialog(window, writeScan("scan_alive", threeOrgans()));
  CHECK(window.value("scan/liver.known") == "liver");
  CHECK(window.value("scan/use.kidney_left") == "kidney_cortex");
  CHECK(window.value("scan/use.vertebrae_L1") == "rigid");
  CHECK_THAT(window.value("scan/liver.stiffness"), Contains("kPa"));
  // An ellipsoid of half axes 48, 40 and 38 mm has 305.6 ml.
  CHECK(std::abs(window.number("scan/liver.volume") - 305.6) < 10.0);
  CHECK(window.value("scan/from") == "-150");
  CHECK(window.value("scan/background.material") == "fat");
  window.screenshotAtRest("dialog");

  typeInto(window, "filter", "kidney");
  C3DE_WAIT(window, "one label is listed", textOf(s, "scan/count").find("1 of 3 labels") == 0);
  CHECK_FALSE(window.has("scan/use.liver"));
  chooseTissue(window, "kidney_left", "spleen");
  typeInto(window, "filter", "");
  C3DE_WAIT(window, "all are listed", textOf(s, "scan/count").find("3 of 3") == 0);
  setPoints(window, "800");
  window.screenshot("chosen");

  // Escape belongs to the list; the dialog stays open. It reopens after the file dialog, with a file and without.
  window.click("scan/use.liver");
  C3DE_WAIT(window, "the list is open", s["widgets"].contains("scan/use.liver.option.liver"));
  window.key("Escape");
  C3DE_WAIT(window, "it is closed", !s["widgets"].contains("scan/use.liver.option.liver"));
  window.waitFrames(2);
  CHECK(window.has("scan/make"));
  const fs::path kept = outputFile("scan_alive.toml");
  fs::remove(kept);
  window.click("scan/save");
  window.click("dialog/cancel");
  C3DE_WAIT(window, "the dialog is back", s["widgets"].contains("scan/make"));
  window.click("scan/save");
  window.openFile(kept);
  C3DE_WAIT(window, "the dialog is back", s["widgets"].contains("scan/make"));
  CHECK(fs::exists(kept));
  CHECK(window.value("scan/use.kidney_left") == "spleen");
  const Json alive = createBody(window);
  CHECK_FALSE(alive["widgets"].contains("scan/make"));
  CHECK(alive["panes"].size() == 4);
  bool isTold = false;
  for (const Json &n : alive["notifications"]) {
    INFO(n.dump());
    CHECK(n["severity"] == "info");
    isTold = isTold || n["title"] == "Scan body created";
  }
  CHECK(isTold);
  window.screenshot("alive");

  // Its organs are in the 3D view, and the tree shows and hides them.
  C3DE_WAIT(window, "organs are in the tree", s["widgets"].contains("scene/tissues"));
  CHECK(window.has("scene/liver"));
  window.waitFrames(3);
  window.screenshot("organs");
  window.click("scene/liver");
  window.waitFrames(3);
  window.screenshot("without_liver");
  CHECK(window.differsFrom("organs", "without_liver", 500, "3D"));
  CHECK(window.differingPixels("organs", "without_liver", "axial") < 20);
  window.click("scene/liver");
  window.click("scene/tissues/fold");
  C3DE_WAIT(window, "the list is folded", !s["widgets"].contains("scene/liver"));
  window.waitFrames(3);
  window.screenshot("folded");
  CHECK(window.differingPixels("organs", "folded", "3D") < 20);

  takePinch(window);
  const Point from = window.inSlice("axial", -60, -20), to = window.inSlice("axial", -65, -35);
  window.moveTo(from);
  // It is in equilibrium: nothing has moved on its own.
  const Json resting = C3DE_WAIT(window, "the read-out is there", isOver(s, "axial", -1));
  CHECK_FALSE(isOver(resting, "axial", 0.2));
  pull(window, from, to);
  C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 4.0));
  window.waitFrames(20);
  window.screenshot("pulled");
  CHECK(window.differsFrom("alive", "pulled", 200, "axial"));
  window.release();
}

TEST_CASE("What image and labels contradict is shown before the body is made, until the choice is another",
          "[scan_findings]") {
  C3DE_ORGAN_OR_SKIP();
  std::vector<ScannedOrgan> organs = threeOrgans({"vertebrae_L2", "kidney_left", "vertebrae_L1"});
  organs[0].value = 40;
  WorkstationDriver window("scan_findings");
  const ScanFiles files = writeScan("scan_findings", organs);
  openDialog(window, files);
  const auto findings = [](const Json &s) { return textOf(s, "scan/findings"); };
  const Json shown = C3DE_WAIT(window, "a finding", !findings(s).empty());
  CHECK_THAT(findings(shown), Contains("1 of 2 rigid labels") && Contains("vertebrae_L2 (") && Contains("material"));
  window.screenshotAtRest("dialog");
  chooseTissue(window, "vertebrae_L2", "liver");
  C3DE_WAIT(window, "no finding", s["jobs"].empty() && findings(s).empty());

  // Its labels can be exported in their current state; it is in equilibrium with its weight.
  setPoints(window, "300");
  (void)createBody(window);
  const auto before = imaging::readLabelMap(files.labels),
             after = imaging::readLabelMap(exported(window, "export_labels", "scan_findings_labels.nrrd"));
  REQUIRE((before && after));
  REQUIRE(after->labels.voxels.size() == before->labels.voxels.size());
  std::size_t other = 0;
  for (std::size_t v = 0; v < after->labels.voxels.size(); ++v)
    other += after->labels.voxels[v] != before->labels.voxels[v] ? 1 : 0;
  CHECK(100 * other < after->labels.voxels.size());
  REQUIRE(after->labels.labels.size() == 3);
  CHECK(after->labels.labels[0].name == "vertebrae_L2");
}

TEST_CASE("where another scan is opened the simulation of the one before is closed by a button of its message",
          "[scan_close]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("scan_close");
  (void)createBodyFromScan(window, "scan_close", "300");
  const ScanFiles other = writeScan("scan_close_other", threeOrgans());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("ctrl+i");
  window.openFile(other.image);
  std::string button;
  // Another message offers to compare the two scans.
  window.waitUntil("it is offered to close the simulation", [&](const Json &s) {
    for (std::size_t i = 0; i < s["notifications"].size(); ++i) {
      if (s["notifications"][i]["title"] != "The simulation is still open") continue;
      button =
          "notification/choose." + std::to_string(s["notifications"].size() - 1 - i) + ".0";  // the newest is on top
      return s["widgets"].contains(button);
    }
    return false;
  });
  window.screenshot("offered");
  window.click(button);
  const Json closed = C3DE_WAIT(window, "the simulation is closed", s["transport"]["exists"] == false);
  CHECK(closed["panes"].size() == 4);
  // No message about its bodies remains.
  for (const char *title : {"The simulation is still open", "Scan body created", "Incomplete body"})
    CHECK(closed["notifications"].dump().find(title) == std::string::npos);
  C3DE_WAIT(window, "the image is shown as it was read",
            !s["values"].contains("image/axial.outlines") || textOf(s, "image/axial.outlines") == "0");
  window.screenshot("closed");

  // The menu offers it, too.
  window.click("menu/file");
  window.waitUntil("there is none to close", [](const Json &s) {
    const Json &disabled = s["disabled"];
    return std::find(disabled.begin(), disabled.end(), "menu/file.close_simulation") != disabled.end();
  });
}

TEST_CASE("A scan that cannot become a body says why, and what is there stays", "[scan_not_alive]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("scan_not_alive");
  openDialog(window, writeScan("scan_not_alive", threeOrgans({"gizmo", "thing", "something"})));
  CHECK(window.value("scan/gizmo.known") == "not known");
  CHECK_THAT(window.value("scan/count"), Contains("3 not known"));
  CHECK_THAT(window.value("scan/reason"), Contains("no label is known by its name"));
  window.click("scan/background");
  window.waitForValue("scan/use.gizmo", "left out");
  const Json state = window.state();
  CHECK(std::find(state["disabled"].begin(), state["disabled"].end(), "scan/make") != state["disabled"].end());
  window.screenshotAtRest("unknown");
  chooseTissue(window, "gizmo", "rigid");
  C3DE_WAIT(window, "nothing could move",
            textOf(s, "scan/reason").find("nothing could move: all labels are rigid") == 0);
  chooseTissue(window, "gizmo", "liver");
  typeInto(window, "points", "300");
  window.key("Tab");

  // The loader refuses a region without tissue; the dialog reopens automatically, where nothing moves.
  window.click("scan/region");
  window.waitForValue("scan/region", "true");
  typeInto(window, "region.x.from", "110");
  window.key("Tab");
  window.waitForValue("scan/region.x.from", "110");
  const auto refuse = [&] {
    window.click("scan/make");
    return C3DE_WAIT(window, "it is refused",
                     s["jobs"].empty() && s["widgets"].contains("scan/make") &&
                         textOf(s, "scan/problem").find("nothing is left of what was asked for") != std::string::npos);
  };
  CHECK(refuse()["transport"]["exists"] == false);
  window.screenshotAtRest("refused");
  CHECK(window.value("scan/use.gizmo") == "liver");
  window.click("scan/region");
  window.waitForValue("scan/region", "false");
  (void)createBody(window);

  // And again, while a body exists: that body stays, and continues to play.
  window.click("segmentation/create_scan_body");
  C3DE_WAIT(window, "it is asked again", s["widgets"].contains("scan/make"));
  CHECK(window.value("scan/use.gizmo") == "liver");
  window.click("scan/region");
  typeInto(window, "region.x.from", "110");
  window.key("Tab");
  window.waitForValue("scan/region.x.from", "110");
  const Json refused = refuse();
  window.screenshot("refused_again");
  CHECK(refused["transport"]["exists"] == true);
  CHECK(refused["transport"]["mode"] == "playing");
  CHECK(refused["panes"].size() == 4);
  window.click("dialog/close");
  C3DE_WAIT(window, "it is closed", !s["widgets"].contains("scan/make"));
}
