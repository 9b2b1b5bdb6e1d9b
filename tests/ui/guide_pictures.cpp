// SPDX-License-Identifier: Apache-2.0
// Takes the pictures of docs/user/images from the program. Not a test of ctest:
//   xvfb-run -a -s "-screen 0 1280x800x24" build/release/bin/test_ui "[guide]"
// writes guide-NAME.png to test-output/ui; check them and copy those that show what the page describes. pulled.png is
// image_walk-pulled.png of the scenario image_walk, loads.png, measurements.png and body_update.png are
// organ_loads-set.png, measurements-placed.png and body_update-added.png; load_arrow.png is block_loads-dragged.png,
// match.png is match-arrows.png.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "support/environment.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

void chooseItem(WorkstationDriver &window, const std::string &parameter, const std::string &item) {
  window.choose(kPanel + parameter, item);
  window.waitForValue(kPanel + parameter, item);
}

/// Pulls the neck of the organ upwards, takes the picture, releases it.
void pullNeck(WorkstationDriver &window, const std::string &picture) {
  window.moveTo(window.inView(0.46, 0.43));
  window.press();
  C3DE_WAIT(window, "a surfel is held", s["values"].contains(kPanel + "Held surfel"));
  for (int i = 1; i <= 10; ++i) window.moveTo(window.inView(0.46 + 0.004 * i, 0.43 - 0.025 * i));
  const double from = window.state()["transport"]["time_s"];
  C3DE_WAIT(window, "it has followed", s["transport"]["time_s"].get<double>() > from + 0.8);
  window.screenshot(picture);
  window.release();
}

}  // namespace

TEST_CASE("Pictures of the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("guide");
  window.start({"--play", (std::filesystem::path(testResourcesFolder()) / "scenes" / "first_light.toml").string()});
  const auto rest = [&](double seconds) {
    const double from = window.state()["transport"]["time_s"];
    C3DE_WAIT(window, "it rests", s["transport"]["time_s"].get<double>() > from + seconds);
  };
  // Each picture begins when the organ is at rest after its fall.
  const auto fallAgain = [&] {
    window.moveTo(window.inView(0.9, 0.1));
    window.key("ctrl+r");
    C3DE_WAIT(window, "it is reset", s["transport"]["time_s"].get<double>() < 1.0);
    rest(3.0);
  };
  C3DE_WAIT(window, "the organ is shown", s["values"].contains(kPanel + "Surfels"));
  window.moveTo(window.inView(0.9, 0.1));
  window.key("f");
  // Space for the legend.
  window.drag(window.inView(0.9, 0.9), window.inView(0.85, 0.91), 3, 2);
  fallAgain();
  window.key("p");
  pullNeck(window, "window");
  fallAgain();
  chooseItem(window, "view.surface", "transparent");
  pullNeck(window, "pinch_transparent");
  fallAgain();
  chooseItem(window, "view.colour", "error");
  window.moveTo(window.inView(0.9, 0.1));
  rest(0.3);
  window.screenshot("error");
  chooseItem(window, "view.surface", "opaque");
  chooseItem(window, "view.colour", "von_mises");
  pullNeck(window, "stress");
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("Pictures of images for the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  WorkstationDriver window("guide");
  window.start({image.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  window.click("image/volume");
  window.click("image/slices_in_space");
  window.clickAt(window.inPane("axial", 0.31, 0.62));
  window.key("4");
  C3DE_WAIT(window, "the preset is set", s["values"].value("image/preset", "") == "CT abdomen (4)");
  std::this_thread::sleep_for(std::chrono::seconds(2));  // the volume is refined
  window.screenshot("image");
}

TEST_CASE("A picture of two scans for the user guide", "[.guide][.guide_comparison]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  // The same patient, 5 degrees and some millimetres off.
  auto read = imaging::readVolume(image);
  REQUIRE(read);
  const double c = std::cos(0.087), s = std::sin(0.087);
  Mat4 &place = read->volume.geometry.indexToWorld;
  place = multiply({c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 6, -9, 4, 1}, place);
  const std::filesystem::path second = outputFile("guide_follow_up.nrrd");
  REQUIRE(imaging::writeVolume(second, read->volume));
  WorkstationDriver window("guide");
  window.start({image.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  window.clickMenu("file.open_comparison");
  window.openFile(second);
  C3DE_WAIT(window, "both are shown", textOf(s, "comparison/name") == second.filename().string());
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.key("4");
  window.click("image/header");
  window.click("segmentation/header");
  window.choose("comparison/mode", "checkerboard");
  window.enterNumber("comparison/square", "40");
  window.enterNumber("comparison/window", "300");
  window.enterNumber("comparison/level", "110");
  window.clickAt(window.inPane("axial", 0.31, 0.62));
  window.screenshotAtRest("comparison");
}

TEST_CASE("A picture of the brush for the user guide", "[.guide][.guide_brush]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  WorkstationDriver window("guide");
  window.start({image.string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  const Point from = window.inPane("axial", 0.28, 0.42), to = window.inPane("axial", 0.40, 0.48);
  window.moveTo(from);
  window.key("4");
  window.key("k");
  C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
  window.enterNumber("segmentation/brush_radius", "14");
  const auto picked = [&](const std::string &what, const std::string &last) {
    C3DE_WAIT(window, what, s["jobs"].empty() && textOf(s, "segmentation/Steps").ends_with(last));
  };
  window.drag(from, to, 8);
  picked("a stroke is painted", "painted");
  window.moveTo(from);
  for (int i = 0; i < 12; ++i) window.wheel(1);
  window.drag(window.inPane("axial", 0.30, 0.44), window.inPane("axial", 0.36, 0.47), 8);
  picked("another one is painted", "painted, painted");
  window.click("segmentation/fill_between");
  picked("the slices are filled", "between");
  window.moveTo(from);
  for (int i = 0; i < 6; ++i) window.wheel(-1);
  window.key("e");
  window.clickAt(window.inPane("axial", 0.34, 0.43));
  picked("a disc is erased", "erased");
  window.clickAt(window.inPane("coronal", 0.9, 0.9));
  window.moveTo(window.inPane("axial", 0.34, 0.47));
  window.screenshotAtRest("brush");
}

TEST_CASE("Pictures of cuts and transparent surfaces for the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  if (!std::filesystem::exists("/usr/share/mricron/templates/ch2bet.nii.gz"))
    C3DE_SKIP("mricron-data is not installed");
  WorkstationDriver window("guide");
  window.start({(std::filesystem::path(testResourcesFolder()) / "scenes" / "brain_shift.toml").string()});
  C3DE_WAIT(window, "the brain is there",
            s["panes"].size() == 4 && s["jobs"].empty() &&
                std::strtod(s["values"].value("image/axial.outlines", "0").c_str(), nullptr) > 0);
  const auto picture = [&](const char *name) {
    window.moveTo(window.inPane("3D", 0.95, 0.95));
    std::this_thread::sleep_for(std::chrono::seconds(3));  // the volume is refined
    window.screenshot(name);
  };
  window.click("image/volume");
  window.key("space");
  C3DE_WAIT(window, "it settles", s["transport"]["time_s"] > 2.0);
  window.key("space");
  window.moveTo(window.inPane("3D", 0.95, 0.95));
  window.key("shift+s");
  picture("cut");
  window.key("shift+s");
  window.key("shift+s");
  window.key("shift+a");
  window.click("image/slices_in_space");
  picture("cut_without_slices");
  window.click("image/cuts_bodies");
  picture("cut_whole_body");
  chooseItem(window, "view.surface", "transparent");
  picture("cut_transparent");
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("Pictures of the way to an organ for the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  WorkstationDriver window("guide");
  window.start({image.string(), labels.string()});
  C3DE_WAIT(window, "image and labels are shown",
            s["panes"].size() == 4 && s["jobs"].empty() && s["widgets"].contains("segmentation/label_filter"));
  window.clickAt(window.inPane("coronal", 0.25, 0.1));
  window.key("4");
  window.click("segmentation/label_filter");
  window.type("liver");
  window.screenshot("organ_labels");
  window.click("segmentation/label.5");
  window.waitForValue("segmentation/material", "liver");
  window.click("segmentation/close");
  C3DE_WAIT(window, "it is closed",
            s["jobs"].empty() && s["values"].value("segmentation/Steps", "").find("closed by") != std::string::npos);
  window.moveTo(window.inPane("coronal", 0.9, 0.95));
  window.screenshot("organ");

  window.click("segmentation/label_filter");
  window.key("ctrl+a");
  window.type("spleen");
  window.click("segmentation/label.1");
  window.click("segmentation/label_filter");
  window.key("ctrl+a");
  window.type("kidney");
  window.click("segmentation/label.2");
  window.click("segmentation/label.3");
  window.moveTo(window.inPane("coronal", 0.9, 0.95));
  window.screenshot("organs_picked");
  window.click("segmentation/create");
  C3DE_WAIT(window, "they are created", s["jobs"].empty() && s["transport"]["time_s"] > 0.2);
  window.moveTo(window.inPane("coronal", 0.9, 0.95));
  window.screenshot("organs");
}

TEST_CASE("A figure of the brain for the user guide", "[.guide][.guide_figure]") {
  C3DE_WINDOW_OR_SKIP();
  const std::filesystem::path home = outputFile("guide_figure_home"), file = outputFile("guide-figure.png");
  std::filesystem::remove_all(home);
  std::filesystem::remove(file);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("guide");
  window.start({"--play", (std::filesystem::path(testResourcesFolder()) / "scenes" / "brain_living.toml").string()});
  C3DE_WAIT(window, "the brain has settled",
            s["panes"].size() == 4 && s["jobs"].empty() && s["transport"]["time_s"].get<double>() > 4.0);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.clickAt(window.inPane("sagittal", 0.34, 0.3));
  window.key("shift+F12");
  C3DE_WAIT(window, "the dialog is shown", s["widgets"].contains("figure/save"));
  window.screenshotAtRest("figure_dialog");
  window.click("figure/dpi");
  window.key("ctrl+a");
  window.type("150");
  window.key("Tab");
  window.click("figure/save");
  window.enterFile(file);
  C3DE_WAIT(window, "the figure is saved", s["notifications"].dump().find("Figure saved") != std::string::npos);
}

TEST_CASE("A picture of curves for the user guide", "[.guide][.guide_plots]") {
  C3DE_WINDOW_OR_SKIP();
  const std::filesystem::path home = outputFile("guide_plots_home");
  std::filesystem::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("guide");
  window.start({(std::filesystem::path(testResourcesFolder()) / "scenes" / "first_light.toml").string()});
  C3DE_WAIT(window, "the organ is shown", s["values"].contains(kPanel + "Surfels"));
  window.key("ctrl+t");
  window.key("space");
  C3DE_WAIT(window, "it has fallen", s["transport"]["time_s"].get<double>() > 2.0);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const Json area = window.state()["area"];
  window.moveTo({area["x"].get<double>() + 0.6 * area["w"].get<double>(),
                 area["y"].get<double>() + area["h"].get<double>() + 80.0});
  C3DE_WAIT(window, "values are shown", s["values"].contains("plots/hover"));
  window.screenshotAtRest("plots");
}

TEST_CASE("Pictures of the default scene for the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("guide");
  window.start({"--play", (std::filesystem::path(testResourcesFolder()) / "scenes" / "brain_living.toml").string()});
  C3DE_WAIT(window, "the brain has settled",
            s["panes"].size() == 4 && s["jobs"].empty() && s["transport"]["time_s"].get<double>() > 4.0);
  window.clickAt(window.inPane("sagittal", 0.34, 0.3));
  window.waitFrames(5);
  window.screenshot("brain_shift");

  window.key("p");
  const Point from = window.inPane("axial", 0.44, 0.52);
  window.moveTo(from);
  window.press();
  C3DE_WAIT(window, "tissue is held", s["values"].contains(kPanel + "Held inside"));
  for (int i = 1; i <= 10; ++i) window.moveTo({from.x + 3.0 * i, from.y + 5.0 * i});
  const double pulled_s = window.state()["transport"]["time_s"];
  C3DE_WAIT(window, "it has followed", s["transport"]["time_s"].get<double>() > pulled_s + 0.8);
  window.screenshot("pull_in_slice");
  window.release();
}

TEST_CASE("Pictures of instruments and of an implant for the user guide", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  const std::filesystem::path folder = std::filesystem::path(testOutputRoot()) / "ui";
  std::filesystem::create_directories(folder);
  std::ofstream plate(folder / "guide_plate.obj");
  for (const double x : {-35.0, 35.0})
    for (const double y : {56.0, 62.0})
      for (const double z : {-18.0, 18.0}) plate << "v " << x << ' ' << y << ' ' << z << '\n';
  plate
      << "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n";
  plate.close();
  const auto sceneWith = [&](const std::string &name, const std::string &more) {
    std::ofstream(folder / name) << "format = 1\n[solver]\ndamping = 10.0\n[[body]]\nname = \"organ\"\nmesh = \""
                                 << organMesh().generic_string()
                                 << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
                                    "sampling = { count = 3000 }\n[[attachment]]\nname = \"around\"\n"
                                    "bodies = [\"organ\", \"surroundings\"]\nstiffness = 5e4\n"
                                 << more;
    return (folder / name).string();
  };
  const auto isShown = [](const Json &s) { return s["values"].contains(kPanel + "Surfels") && s["jobs"].empty(); };
  const auto rest = [](WorkstationDriver &window) {
    const double from = window.state()["transport"]["time_s"];
    C3DE_WAIT(window, "it rests", s["transport"]["time_s"].get<double>() > from + 2.0);
  };
  {
    WorkstationDriver window("guide");
    window.start({"--play", sceneWith("guide_touch.toml", "")});
    window.waitUntil("the organ is shown", isShown);
    window.moveTo(window.inView(0.5, 0.5));
    window.key("f");
    window.key("t");
    window.moveTo(window.inView(0.42, 0.56));
    window.press();
    window.wheel(10);
    window.moveTo(window.inView(0.45, 0.55));
    rest(window);
    window.release();
    window.moveTo(window.inView(0.9, 0.1));
    rest(window);
    window.screenshot("touch");
  }
  {
    WorkstationDriver window("guide");
    window.start({"--play", sceneWith("guide_grasp.toml", "")});
    window.waitUntil("the organ is shown", isShown);
    window.moveTo(window.inView(0.5, 0.5));
    window.key("f");
    window.key("g");
    const auto at = window.inView(0.4, 0.5);
    window.moveTo({at.x - 20, at.y});
    window.moveTo(at);
    window.press();
    rest(window);
    for (int k = 1; k <= 10; ++k) window.moveTo({at.x - 4 * k, at.y - 16 * k});
    rest(window);
    window.release();
    window.moveTo(window.inView(0.9, 0.1));
    rest(window);
    window.screenshot("grasp");
  }
  {
    WorkstationDriver window("guide");
    window.start({"--play", sceneWith("guide_implant.toml",
                                      "[[obstacle]]\nname = \"plate\"\nmesh = \"guide_plate.obj\"\nmesh_unit = \"mm\"\n"
                                      "[view]\ncolour = \"contact_pressure\"\n")});
    window.waitUntil("the organ is shown", isShown);
    window.moveTo(window.inView(0.5, 0.5));
    window.key("f");
    window.key("m");
    window.choose(kPanel + "placed", "plate");
    window.enterNumber(kPanel + "placed_y", "46");
    rest(window);
    // The part below it.
    window.click("scene/plate");
    window.drag(window.inView(0.85, 0.55), window.inView(0.85, 0.75), 5);
    window.moveTo(window.inView(0.9, 0.1));
    window.screenshot("implant");
  }
}

TEST_CASE("Pictures of a scan that was made alive for the user guide", "[.guide]") {
  C3DE_ORGAN_OR_SKIP();
  std::vector<ScannedOrgan> organs{{"liver", {-48, -14, 8}, {50, 40, 44}, 110, {0.6f, 0.2f, 0.1f}},
                                   {"gallbladder", {-26, -38, -6}, {12, 14, 16}, 10, {0.1f, 0.5f, 0.1f}},
                                   {"stomach", {30, -26, 10}, {34, 26, 30}, 50, {0.7f, 0.4f, 0.5f}},
                                   {"spleen", {76, 14, 8}, {20, 30, 34}, 125, {0.4f, 0.1f, 0.5f}},
                                   {"kidney_left", {48, 28, -6}, {18, 20, 34}, 190, {0.2f, 0.5f, 0.8f}},
                                   {"kidney_right", {-46, 32, -8}, {18, 20, 34}, 190, {0.1f, 0.4f, 0.7f}},
                                   {"pancreas", {4, -4, 0}, {28, 9, 12}, 90, {0.8f, 0.6f, 0.2f}},
                                   {"aorta", {8, 16, 0}, {9, 9, 1e9}, 220, {0.8f, 0.1f, 0.1f}},
                                   {"inferior_vena_cava", {-14, 14, 0}, {10, 8, 1e9}, 150, {0.1f, 0.1f, 0.7f}},
                                   {"autochthon_left", {24, 56, 0}, {16, 10, 1e9}, 60, {0.5f, 0.2f, 0.2f}},
                                   {"autochthon_right", {-24, 56, 0}, {16, 10, 1e9}, 60, {0.5f, 0.2f, 0.2f}},
                                   {"vertebrae_L1", {0, 38, 0}, {19, 15, 1e9}, 420, {0.9f, 0.9f, 0.6f}},
                                   {"finding_7", {-72, -2, 12}, {9, 9, 9}, 60, {0.3f, 0.8f, 0.8f}}};
  // Ribs, where they are cut across.
  for (int rib = 0; rib < 6; ++rib)
    for (const double side : {-1.0, 1.0}) {
      const double angle = -0.6 + 0.32 * rib;
      organs.push_back({(side > 0 ? "rib_left_" : "rib_right_") + std::to_string(rib + 6),
                        {side * 102 * std::cos(angle), 64 * std::sin(angle), 0},
                        {5, 8, 1e9},
                        600,
                        {0.8f, 0.8f, 0.7f}});
    }
  WorkstationDriver window("guide");
  openDialog(window, writeScan("guide_scan", organs, 2.0));
  chooseTissue(window, "finding_7", "liver_hcc");
  window.screenshotAtRest("alive_dialog");
  window.click("scan/draw_region");
  (void)window.locate("region/axial.left");
  window.moveTo(window.inSlice("axial", 0, 0));
  window.key("4");
  window.drag(window.inSlice("axial", -100, -66), window.inSlice("axial", 20, 42), 4);
  window.drag(window.locate("region/coronal.top"), window.inSlice("coronal", 0, -30), 4);
  window.moveTo(window.locate("region/axial.bottom_right"));
  window.screenshotAtRest("region");
  window.click("region/cancel");
  (void)createBody(window);
  takePinch(window);
  window.moveTo(window.inSlice("axial", 0, 0));
  window.key("4");  // window and level of the abdomen
  pull(window, window.inSlice("axial", 32, -30), window.inSlice("axial", 40, -56));
  C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 8.0));
  window.waitFrames(20);
  window.screenshot("alive");
  window.release();

  window.click("notification/close.0");
  const auto pullWith = [&](const std::string &overlay, const std::string &picture) {
    window.choose("image/overlay", overlay);
    if (picture == "tissue_table") window.click("tissues/header");
    pull(window, window.inSlice("axial", 32, -30), window.inSlice("axial", 40, -56));
    C3DE_WAIT(window, "the scan follows", isOver(s, "axial", 8.0));
    window.waitFrames(60);
    window.screenshot(picture);
    window.release();
  };
  pullWith("equivalent stress", "fields");
  pullWith("volume change", "tissue_table");
}

TEST_CASE("Picture of a liver that is pulled for the first page", "[.guide]") {
  C3DE_ORGAN_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  WorkstationDriver window("guide");
  openDialog(window, {image, labels});
  (void)createBody(window);
  C3DE_WAIT(window, "organs are in the tree", s["widgets"].contains("scene/tissues"));
  window.click("notification/close.0");
  window.click("notification/close.0");
  window.click("tissues/header");
  window.enterNumber("image/label_opacity", "0.3");
  window.clickAt(window.inSlice("axial", -75, 8));
  window.clickAt(window.inSlice("coronal", -75, -107));
  takePinch(window);
  window.click("image/slices_in_space");
  window.moveTo(window.inView(0.5, 0.5));
  window.key("1");
  window.drag(window.inView(0.5, 0.9), window.inView(0.42, 0.98), 4);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  window.wheel(2);
  window.moveTo(window.inSlice("axial", 0, 0));
  window.key("4");
  (void)window.locate("tissues/filter");
  window.click("tissues/order.largest");
  pull(window, window.inSlice("coronal", -100, -98), window.inSlice("coronal", -58, -84));
  const double begin = window.state()["transport"]["time_s"];
  C3DE_WAIT(window, "the tissue has come after the hand", s["transport"]["time_s"].get<double>() > begin + 2.5);
  window.screenshot("liver");
  window.release();
}

TEST_CASE("Pictures of the modes of the panel for the user guide", "[.guide][.guide_panel]") {
  C3DE_ORGAN_OR_SKIP();
  const auto home = outputFile("guide_panel_home");
  std::filesystem::remove_all(home);
  const ScopedEnvironment person("C3DE_HOME", home.string());
  WorkstationDriver window("guide");
  window.asNewUser();
  window.start({"--play", (std::filesystem::path(testResourcesFolder()) / "scenes" / "first_light.toml").string()});
  window.choose(kPanel + "tissue", "liver");
  C3DE_WAIT(window, "it lies on the block",
            !textOf(s, kPanel + "Contact with block").empty() && s["transport"]["time_s"].get<double>() > 5.0);
  window.click("scene/header");
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  window.screenshotAtRest("panel_simple");
  window.click(kPanel + "view.mode.all");
  window.click(kPanel + "rows.search");
  window.type("volume stiffness");
  C3DE_WAIT(window, "a row is found", s["widgets"].contains(kPanel + "material.volume_stiffness"));
  window.moveTo(window.inView(0.9, 0.1));
  window.waitFrames(3);
  window.screenshot("panel_search");  // the text cursor blinks
}

TEST_CASE("Preferences for the user guide", "[.guide][.guide_preferences]") {
  C3DE_ORGAN_OR_SKIP();
  // A short name of the file in the picture.
  const ScopedEnvironment person("C3DE_HOME", "guide_preferences");
  std::filesystem::remove_all("guide_preferences");
  std::filesystem::create_directories("guide_preferences/config");
  std::ofstream("guide_preferences/config/config.toml")
      << "[appearance]\ntheme = \"light\"\n[units]\npressure = \"mmHg\"\n"
         "[[window_level]]\nname_contains = \"CT thorax lung\"\ncentre = -600\nwidth = 1500\n"
         "[[window_level]]\nname_contains = \"CT liver\"\ncentre = 80\nwidth = 160\n";
  WorkstationDriver window("guide");
  window.start({(std::filesystem::path(testResourcesFolder()) / "scenes" / "first_light.toml").string()});
  C3DE_WAIT(window, "the organ is shown", s["values"].contains(kPanel + "Surfels") && s["jobs"].empty());
  window.key("ctrl+comma");
  C3DE_WAIT(window, "the preferences are shown", s["widgets"].contains("preferences/restore"));
  window.screenshotAtRest("preferences");
}

TEST_CASE("The plugin manager", "[.guide]") {
  C3DE_WINDOW_OR_SKIP();
  // In a user's home folder.
  const auto home = outputFile("guide_home");
  std::filesystem::remove_all(home);
  const auto plugins = home / "plugins";
  std::filesystem::create_directories(plugins);
  std::filesystem::copy(testExampleFolder(), plugins);
  const ScopedEnvironment person("HOME", home.string());
  WorkstationDriver window("guide_plugins");
  window.start({"--plugin-path", plugins.string(), "--without", "org.c3de.material_law"});
  C3DE_WAIT(window, "the organ is shown", s["values"].contains(kPanel + "Surfels"));
  window.key("ctrl+shift+p");
  C3DE_WAIT(window, "the manager is open", s["widgets"].contains("dialog/close"));
  window.screenshotAtRest("plugins");
}
