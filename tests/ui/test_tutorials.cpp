// SPDX-License-Identifier: Apache-2.0
// The tutorials of docs/user/tutorials, step by step as they are written, on the synthetic scan. Their screenshots
// tutorial-NAME.png in test-output/ui are the pictures of those pages.
#include <cmath>
#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/image_window.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

const Vec3 kTumour{-76.0, -26.0, 6.0};  // LPS, mm

fs::path shipped(const std::string &name) { return fs::path(testResourcesFolder()) / name; }
ScanFiles scan() { return {shipped("scans/abdomen.nii.gz"), shipped("scans/abdomen_labels.nrrd")}; }

/// A user who starts the program for the first time.
class NewUser {
 public:
  explicit NewUser(const std::string &name) : home_(outputFile("tutorial_" + name + "_home")) { fs::remove_all(home_); }

 private:
  fs::path home_;
  ScopedEnvironment environment_{"C3DE_HOME", home_.string()};
};

void openScan(WorkstationDriver &window) {
  window.asNewUser();
  window.start({scan().image.string(), scan().labels.string()});
  C3DE_WAIT(window, "image and labels are shown",
            s["panes"].size() == 4 && s["jobs"].empty() && s["widgets"].contains("segmentation/label_filter"));
}

}  // namespace

TEST_CASE("Tutorial: see a scan", "[tutorial_scan]") {
  C3DE_WINDOW_OR_SKIP();
  const NewUser user("scan");
  WorkstationDriver window("tutorial");
  openScan(window);
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshotAtRest("scan_open");

  window.clickAt(window.inSlice("axial", kTumour[0], kTumour[1]));
  C3DE_WAIT(window, "the cross-hair is in the tumour", norm(vectorOf(s, "image/cross_hair") - kTumour) < 12.0);
  window.key("6");
  C3DE_WAIT(window, "the window of the liver", textOf(s, "image/preset") == "CT liver (6)");
  const Json at = C3DE_WAIT(window, "the read-out names the label",
                            textOf(s, "image/axial.readout").find("liver_tumor") != std::string::npos);
  INFO(textOf(at, "image/axial.readout"));
  window.enterNumber("image/label_opacity", "0");
  window.clickAt(window.inSlice("axial", kTumour[0], kTumour[1]));
  window.screenshotAtRest("scan_tumour");

  window.click("image/slices_in_space");
  window.waitForValue("image/slices_in_space", "false");
  window.click("image/volume");
  window.waitForValue("image/volume", "true");
  window.doubleClickAt(window.inPane("3D", 0.9, 0.9));
  C3DE_WAIT(window, "the 3D view is alone", s["panes"].size() == 1);
  window.key("f");
  window.key("shift+c");
  window.waitForValue("image/cut_coronal", "without the front");
  window.screenshotAtRest("scan_volume");
}

TEST_CASE("Tutorial: an organ comes alive", "[tutorial_organ]") {
  C3DE_ORGAN_OR_SKIP();
  {
    const NewUser user("organ");
    WorkstationDriver window("tutorial");
    openScan(window);
    window.click("segmentation/label.1");
    window.waitForValue("segmentation/material", "liver");
    const double labelled = window.number("segmentation/Picked");
    window.click("segmentation/fill_holes");
    C3DE_WAIT(window, "the tumour is part of it",
              s["jobs"].empty() && numberOf(s, "segmentation/Picked") > labelled + 7.0);
    window.screenshotAtRest("organ_picked");
    window.click("segmentation/create");
    C3DE_WAIT(window, "it plays", s["jobs"].empty() && s["transport"]["time_s"] > 0.2);
    takePinch(window);
    pull(window, window.inSlice("axial", kTumour[0], kTumour[1]),
         window.inSlice("axial", kTumour[0] + 30, kTumour[1] - 22));
    C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 6.0));
    window.waitFrames(40);
    window.screenshot("organ_pulled");
    window.release();
    window.key("ctrl+z");
    C3DE_WAIT(window, "it is as before the pull", displacement_mm(s, "axial") < 1.0 || mode(s) == "paused");
  }
  const NewUser user("organ_stands");
  WorkstationDriver window("tutorial");
  window.asNewUser();
  window.start({"--play", shipped("scenes/living_scan.toml").string()});
  C3DE_WAIT(window, "the patient stands", s["jobs"].empty() && s["transport"]["time_s"].get<double>() > 3.0);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.choose("image/overlay", "|u|");
  window.clickAt(window.inSlice("coronal", kTumour[0], 0.0));
  C3DE_WAIT(window, "it is in the legend", textOf(s, "image/coronal.legend").starts_with("|u| "));
  window.screenshotAtRest("organ_stands");
  CHECK(isOver(window.state(), "coronal", 8.0));
}

TEST_CASE("Tutorial: the whole scan", "[tutorial_whole]") {
  C3DE_ORGAN_OR_SKIP();
  const NewUser user("whole");
  WorkstationDriver window("tutorial");
  openScan(window);
  window.clickMenu("file.create_scan_body");
  C3DE_WAIT(window, "the labels are measured",
            s["widgets"].contains("scan/make") && textOf(s, "scan/reason").find("measured") == std::string::npos);
  CHECK(window.value("scan/use.vertebrae_L1") == "rigid");
  CHECK(textOf(window.state(), "scan/findings").empty());
  window.screenshotAtRest("whole_dialog");
  (void)createBody(window);
  window.enterNumber("image/label_opacity", "0.25");
  window.choose("image/overlay", "|u|");
  takePinch(window);
  pull(window, window.inSlice("coronal", kTumour[0] - 10, 20), window.inSlice("coronal", kTumour[0] + 30, 36));
  C3DE_WAIT(window, "the scan follows", isOver(s, "coronal", 6.0));
  window.waitFrames(60);
  window.screenshot("whole_pulled");
  window.release();
  window.click("tissues/header");
  window.click("tissues/order.largest");
  pull(window, window.inSlice("coronal", kTumour[0] - 10, 20), window.inSlice("coronal", kTumour[0] + 30, 36));
  C3DE_WAIT(window, "the table has followed", numberOf(s, "tissues/liver.largest") > 5.0);
  CHECK(numberOf(window.state(), "tissues/vertebrae_L1.largest") == 0.0);
  window.waitFrames(60);
  window.screenshot("whole_table");
  window.release();
}

TEST_CASE("Tutorial: how accurate is it", "[tutorial_accuracy]") {
  C3DE_ORGAN_OR_SKIP();
  const NewUser user("accuracy");
  WorkstationDriver window("tutorial");
  window.asNewUser();
  window.start({"--play", shipped("scenes/living_scan.toml").string()});
  C3DE_WAIT(window, "the patient stands", s["jobs"].empty() && s["transport"]["time_s"].get<double>() > 3.0);
  window.key("space");
  C3DE_WAIT(window, "it is estimated",
            mode(s) == "paused" && row(s, "Displacement").find("estimated") != std::string::npos);
  window.locate(kPanel + "verify");
  window.screenshotAtRest("accuracy_estimated");
  window.click(kPanel + "verify");
  C3DE_WAIT(window, "it is measured", row(s, "Displacement").find("verified with") != std::string::npos);
  window.choose(kPanel + "view.colour", "verified");
  C3DE_WAIT(window, "colours show it", row(s, "Colours").starts_with("Error, verified, 0"));
  window.doubleClickAt(window.inPane("3D", 0.1, 0.9));
  C3DE_WAIT(window, "the 3D view is alone", s["panes"].size() == 1);
  window.key("f");
  window.screenshotAtRest("accuracy_verified");
}
