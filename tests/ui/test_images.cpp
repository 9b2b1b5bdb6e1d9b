// SPDX-License-Identifier: Apache-2.0
// User actions with an image in the window: scroll, point, change window and level, maximise, overlay labels, see an
// organ cut by the slices and pull it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "c3de/imaging/reading.h"
#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "ui/workstation_driver.h"
#include "unit/render/phantom.h"

using namespace c3de;  // operators of Vec3
using c3de::test::Json;
using c3de::test::outputFile;
using c3de::test::Point;
using c3de::test::WorkstationDriver;

namespace {

namespace fs = std::filesystem;
using c3de::render::test::Phantom;

/// 80 x 90 x 50 voxels of 2 x 2 x 3 mm around the origin: letters L, A, S on a block of 60 mm.
Phantom phantom() {
  return c3de::render::test::makePhantom({80, 90, 50}, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, -79, -89, -73.5, 1});
}

/// Each scenario has its own files, since scenarios run concurrently.
fs::path imageFile(const std::string &scenario) {
  const Phantom p = phantom();
  c3de::imaging::Volume volume;
  volume.geometry = {p.size, p.worldFromIndex};
  volume.voxels = p.voxels;
  const fs::path file = outputFile(scenario + "_phantom.nii.gz");
  const auto written = c3de::imaging::writeVolume(file, volume);
  if (!written) FAIL(written.error().message);
  return file;
}

fs::path labelFile(const std::string &scenario, const std::string &extension = ".nii.gz") {
  const Phantom p = phantom();
  c3de::imaging::LabelMap map;
  map.geometry = {p.size, p.worldFromIndex};
  map.voxels = p.labels;
  map.labels = {{1, "block", {0.1f, 0.6f, 0.1f}}, {2, "letters", {1.0f, 0.2f, 0.1f}}};
  const fs::path file = outputFile(scenario + "_labels" + extension);
  const auto written = c3de::imaging::writeLabelMap(file, map);
  if (!written) FAIL(written.error().message);
  return file;
}

void startOn(WorkstationDriver &window, const std::vector<std::string> &files) {
  window.start(files);
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
}

Point inPane(const WorkstationDriver &window, const char *pane, double u, double v) {
  const Json r = window.state()["panes"][pane];
  return {r["x"].get<double>() + u * r["w"].get<double>(), r["y"].get<double>() + v * r["h"].get<double>()};
}

double number(const Json &state, const std::string &key) {
  return std::strtod(state["values"].value("image/" + key, std::string("nan")).c_str(), nullptr);
}

std::string text(const Json &state, const std::string &key) {
  return state["values"].value("image/" + key, std::string());
}

Vec3 crossHair(const Json &state) {
  Vec3 at{};
  std::istringstream in(text(state, "cross_hair"));
  in >> at[0] >> at[1] >> at[2];
  return at;
}

/// Position of a world point in the pane, by the frame of radiological views of an image along the axes.
Point pixelOf(const WorkstationDriver &window, const std::string &pane, const Vec3 &world) {
  const Json state = window.state();
  const double scale = number(state, pane + ".scale_mm_per_px");
  const double right = pane == "sagittal" ? world[1] : world[0], down = pane == "axial" ? world[1] : -world[2];
  const Json r = state["panes"][pane];
  return {r["x"].get<double>() + 0.5 * r["w"].get<double>() + right / scale,
          r["y"].get<double>() + 0.5 * r["h"].get<double>() + down / scale};
}

}  // namespace

TEST_CASE("slices scroll by wheel and keys, each view by itself", "[image_scroll]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_scroll");
  startOn(window, {imageFile("image_scroll").string()});
  const Json first = window.state();
  CHECK(first["view"] == first["panes"]["3D"]);
  CHECK(text(first, "axial.letters") == "R|L|A|P");
  CHECK(text(first, "sagittal.letters") == "A|P|S|I");
  CHECK(text(first, "coronal.letters") == "R|L|S|I");
  const double axial = number(first, "axial.slice"), coronal = number(first, "coronal.slice");
  const auto waitForSlice = [&](const char *pane, double slice) {
    return C3DE_WAIT(window, "the slice changes", number(s, std::string(pane) + ".slice") == slice);
  };
  window.moveTo(inPane(window, "axial", 0.3, 0.4));
  window.wheel(3);
  waitForSlice("axial", axial + 3);
  window.key("b");
  waitForSlice("axial", axial + 2);
  window.key("shift+Up");
  waitForSlice("axial", axial + 12);
  window.key("Left");
  const Json later = waitForSlice("axial", axial + 11);
  CHECK(number(later, "coronal.slice") == coronal);
  CHECK(later["transport"]["steps"] == 0);
  window.moveTo(inPane(window, "coronal", 0.3, 0.4));
  window.key("f");
  waitForSlice("coronal", coronal + 1);
  window.screenshot("scrolled");
}

TEST_CASE("modifiers count for the wheel and the mouse as they are held, not one event later", "[image_modifiers]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_modifiers");
  startOn(window, {imageFile("image_modifiers").string()});
  const double first = number(window.state(), "axial.slice"), scale = number(window.state(), "axial.scale_mm_per_px");
  window.moveTo(inPane(window, "axial", 0.3, 0.4));
  window.keyDown("ctrl");
  window.wheel(1);
  const Json zoomed = C3DE_WAIT(window, "it zooms or scrolls",
                                number(s, "axial.scale_mm_per_px") != scale || number(s, "axial.slice") != first);
  CHECK(number(zoomed, "axial.slice") == first);
  const double closer = number(zoomed, "axial.scale_mm_per_px");
  CHECK(closer < scale);
  window.keyUp("ctrl");
  window.wheel(1);
  const Json scrolled = C3DE_WAIT(window, "it scrolls or zooms",
                                  number(s, "axial.scale_mm_per_px") != closer || number(s, "axial.slice") != first);
  CHECK(number(scrolled, "axial.slice") == first + 1);
  CHECK(number(scrolled, "axial.scale_mm_per_px") == closer);
  window.keyDown("shift");
  window.wheel(1);
  C3DE_WAIT(window, "ten slices", number(s, "axial.slice") == first + 11);
  window.keyUp("shift");
  window.wheel(-1);
  C3DE_WAIT(window, "one slice", number(s, "axial.slice") == first + 10);
  // Shift and a move set the cross-hair, a move without it does not.
  const Vec3 before = crossHair(window.state());
  window.keyDown("shift");
  window.moveTo(inPane(window, "axial", 0.4, 0.6));
  const Json pointed = C3DE_WAIT(window, "the cross-hair follows", norm(crossHair(s) - before) > 1.0);
  window.keyUp("shift");
  window.moveTo(inPane(window, "axial", 0.6, 0.45));
  window.waitFrames(0);
  CHECK(norm(crossHair(window.state()) - crossHair(pointed)) < 1e-9);
}

TEST_CASE("R is the reset of the view under the mouse, and Ctrl+R that of the simulation", "[image_reset]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_reset");
  startOn(window, {imageFile("image_reset").string()});
  const Json first = window.state();
  window.moveTo(inPane(window, "axial", 0.3, 0.4));
  window.wheel(3);
  window.moveTo(inPane(window, "coronal", 0.3, 0.4));
  window.wheel(2);
  C3DE_WAIT(window, "both have scrolled",
            number(s, "axial.slice") == number(first, "axial.slice") + 3 &&
                number(s, "coronal.slice") == number(first, "coronal.slice") + 2);
  window.key("r");
  C3DE_WAIT(window, "this one is as at the start", number(s, "coronal.slice") == number(first, "coronal.slice"));
  CHECK(number(window.state(), "axial.slice") == number(first, "axial.slice") + 3);
  window.drag(inPane(window, "3D", 0.5, 0.5), inPane(window, "3D", 0.7, 0.6), 3);
  REQUIRE(window.state()["camera"]["yaw"] != first["camera"]["yaw"]);
  window.key("r");
  C3DE_WAIT(window, "the camera is as at the start",
            s["camera"]["yaw"] == first["camera"]["yaw"] && s["camera"]["pitch"] == first["camera"]["pitch"]);
  CHECK(number(window.state(), "axial.slice") == number(first, "axial.slice") + 3);
  // The hint describes the action of the mouse at its position.
  CHECK_THAT(window.value("status/hint"), Contains("orbit"));
  window.moveTo(inPane(window, "axial", 0.3, 0.4));
  window.waitUntil("the hint is that of slices", [](const Json &s) {
    const std::string hint = s["values"].value("status/hint", "");
    return hint.find("cross-hair") != std::string::npos && hint.find("orbit") == std::string::npos;
  });
}

TEST_CASE("a click sets the cross-hair in all views, and the read-out tells what is there", "[image_cross_hair]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_cross_hair");
  startOn(window, {imageFile("image_cross_hair").string(), labelFile("image_cross_hair").string()});
  C3DE_WAIT(window, "the labels are there", s["jobs"].empty() && !text(s, "Label map").empty());
  // The stem of the L: x = 23, y = -6, z = 0.
  window.clickAt(pixelOf(window, "coronal", {23, 0, 0}));
  window.clickAt(pixelOf(window, "sagittal", {0, -6, 0}));
  const Json state = C3DE_WAIT(window, "the cross-hair is there", norm(crossHair(s) - Vec3{23, -6, 0}) < 2.0);
  for (const char *pane : {"axial", "sagittal", "coronal"})
    CHECK(text(state, std::string(pane) + ".cross_hair") == "shown");
  // The mouse is over the sagittal view; the others read at the cross-hair.
  CHECK_THAT(text(state, "axial.readout"), Contains("   700") && Contains("letters") && Contains("mm"));
  window.screenshot("on_the_L");
  window.moveTo(inPane(window, "axial", 0.2, 0.2));
  C3DE_WAIT(window, "the read-out follows the mouse", text(s, "axial.readout").find("-1000") != std::string::npos);
  window.wheel(-2);
  C3DE_WAIT(window, "it is not on that slice", text(s, "axial.cross_hair") == "hidden");
  CHECK(text(window.state(), "coronal.cross_hair") == "shown");
  CHECK(norm(crossHair(window.state()) - crossHair(state)) < 1e-9);
  window.key("c");
  C3DE_WAIT(window, "it is switched off", text(s, "coronal.cross_hair") == "hidden");
}

TEST_CASE("window and level follow a drag in their own mode, and number keys are presets", "[image_window]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_window");
  startOn(window, {imageFile("image_window").string()});
  const Json first = window.state();
  window.moveTo(inPane(window, "axial", 0.5, 0.5));
  window.key("w");
  window.drag(inPane(window, "axial", 0.3, 0.7), inPane(window, "axial", 0.6, 0.3), 4);
  const Json dragged = window.state();
  CHECK(number(dragged, "window") > number(first, "window"));
  CHECK(number(dragged, "level") < number(first, "level"));
  CHECK(norm(crossHair(dragged) - crossHair(first)) < 1e-9);
  window.screenshot("dragged");
  window.key("3");
  C3DE_WAIT(window, "bone", number(s, "window") == 2000.0 && number(s, "level") == 400.0);
  window.key("0");
  C3DE_WAIT(window, "automatic", number(s, "window") == number(first, "window"));
  // In the 3D view the same key is a direction.
  window.moveTo(inPane(window, "3D", 0.5, 0.5));
  window.key("3");
  C3DE_WAIT(window, "the camera has turned", s["camera"]["yaw"] != first["camera"]["yaw"]);
  CHECK(number(window.state(), "window") == number(first, "window"));
  window.click("toolbar/slices.cross_hair");
  window.clickAt(inPane(window, "axial", 0.4, 0.4));
  CHECK(norm(crossHair(window.state()) - crossHair(first)) > 1.0);
}

TEST_CASE("a double click gives a view the whole area, and another one gives it back", "[image_maximise]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_maximise");
  startOn(window, {imageFile("image_maximise").string()});
  const Json four = window.state();
  // The cross-hair never leaves the image: outside, the nearest point of the image is used.
  window.clickAt(inPane(window, "axial", 0.02, 0.5));
  const Json clicked = C3DE_WAIT(window, "the click is taken", norm(crossHair(s) - crossHair(four)) > 1.0);
  CHECK(crossHair(clicked)[0] == Approx(-80.0).margin(1e-3));  // the image ends there
  CHECK_THAT(text(clicked, "coronal.readout"), Contains("["));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  // A double click changes only the views.
  window.doubleClickAt(inPane(window, "axial", 0.8, 0.03));
  const Json onlyAxial = C3DE_WAIT(window, "one view", s["panes"].size() == 1);
  CHECK(crossHair(onlyAxial) == crossHair(clicked));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  window.doubleClickAt(inPane(window, "axial", 0.7, 0.2));
  const Json fourAgain = C3DE_WAIT(window, "four views", s["panes"].size() == 4);
  CHECK(crossHair(fourAgain) == crossHair(clicked));
  for (const char *pane : {"axial", "sagittal", "coronal"})
    CHECK(number(fourAgain, std::string(pane) + ".slice") == number(clicked, std::string(pane) + ".slice"));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  for (const char *pane : {"coronal", "3D"}) {
    window.doubleClickAt(inPane(window, pane, 0.4, 0.4));
    const Json one = C3DE_WAIT(window, "one view", s["panes"].size() == 1 && s["panes"].contains(pane));
    CHECK(one["panes"][pane]["w"] > 1.9 * four["panes"][pane]["w"].get<double>());
    window.screenshot(std::string("only_") + pane);
    // Clicks in quicker succession than a double click count as triple or quadruple clicks.
    std::this_thread::sleep_for(std::chrono::milliseconds(450));
    window.doubleClickAt(inPane(window, pane, 0.4, 0.4));
    const Json back = C3DE_WAIT(window, "four views", s["panes"].size() == 4);
    CHECK(back["panes"] == four["panes"]);
    std::this_thread::sleep_for(std::chrono::milliseconds(450));
  }
  // Closed, the window is as without an image.
  window.click("menu/file");
  window.click("menu/file.close_image");
  const Json closed = window.waitUntil("the image is closed", [](const Json &s) {
    return s["panes"].empty() && s["view"]["w"] > 600 && !s["widgets"].contains("image/header");  // a frame later
  });
  CHECK(closed["nodes"].empty());
}

TEST_CASE("a view shows what has changed in it at once, and no more than that", "[image_kept]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_kept");
  startOn(window, {imageFile("image_kept").string(), labelFile("image_kept").string()});
  C3DE_WAIT(window, "the labels are there", s["jobs"].empty() && !text(s, "Label map").empty());
  const auto shot = [&](const char *name) {
    window.moveTo(inPane(window, "3D", 0.9, 0.9));
    C3DE_WAIT(window, "notices are gone", s["notifications"].empty());
    window.screenshotAtRest(name);
  };
  const auto differ = [&](const char *before, const char *after, const std::vector<std::string> &changed) {
    for (const std::string pane : {"axial", "sagittal", "coronal", "3D"}) {
      INFO(before << " and " << after << ": " << pane);
      const bool isMeant = std::find(changed.begin(), changed.end(), pane) != changed.end();
      CHECK((window.differingPixels(before, after, pane) > 200.0) == isMeant);
    }
  };
  const std::vector<std::string> all{"axial", "sagittal", "coronal", "3D"};
  shot("first");
  // The views overlap, and are restored.
  window.doubleClickAt(inPane(window, "axial", 0.5, 0.5));
  window.waitForValue("image/layout", "axial");
  window.screenshot("alone");
  window.doubleClickAt(inPane(window, "axial", 0.5, 0.5));
  window.waitForValue("image/layout", "four");
  shot("four_again");
  differ("first", "four_again", {});
  window.moveTo(inPane(window, "axial", 0.5, 0.5));
  window.wheel(3);
  C3DE_WAIT(window, "another slice", number(s, "axial.slice") == 27.0);
  shot("scrolled");
  CHECK(window.differingPixels("first", "scrolled", "axial") > 50.0);
  CHECK(window.differingPixels("first", "scrolled", "3D") > 50.0);
  window.click("image/label.1");
  window.waitForValue("image/label.1", "false");
  shot("without_block");
  differ("scrolled", "without_block", all);
  window.click("image/label.1");
  window.waitForValue("image/label.1", "true");
  shot("with_block");
  differ("scrolled", "with_block", {});
  window.moveTo(inPane(window, "axial", 0.5, 0.5));
  window.key("4");
  shot("preset");
  differ("with_block", "preset", all);
  window.drag(inPane(window, "3D", 0.4, 0.5), inPane(window, "3D", 0.6, 0.6), 4);
  shot("turned");
  differ("preset", "turned", {"3D"});
  window.click("scene/" + imageFile("image_kept").filename().string());
  shot("hidden");
  differ("turned", "hidden", {"3D"});
}

TEST_CASE("volume rendering, presets and labels are chosen in the panel", "[image_panel]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_panel");
  startOn(window, {imageFile("image_panel").string(), labelFile("image_panel").string()});
  C3DE_WAIT(window, "the labels are there", s["jobs"].empty() && !text(s, "Label map").empty());
  window.screenshot("before");
  window.click("image/volume");
  window.waitForValue("image/volume", "true");
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  window.screenshot("volume");
  CHECK(window.differingPixels("before", "volume") > 500);
  window.click("image/volume_preset");
  window.click("image/volume_preset.option.MIP");
  window.waitForValue("image/volume_preset", "MIP");
  window.click("image/label.2");
  window.waitForValue("image/label.2", "false");
  window.screenshot("mip");
  for (const Json &n : window.state()["notifications"]) CHECK(n["severity"] == "info");  // source of the names
}

TEST_CASE("the 3D view is cut at the slices by panel, menu and keys", "[image_cut]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_cut");
  startOn(window, {imageFile("image_cut").string()});
  window.click("image/volume");
  window.waitForValue("image/volume", "true");
  window.click("image/volume_preset");
  window.click("image/volume_preset.option.CT soft tissue");
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  const auto settled = [&](const char *name) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // until it is refined
    window.screenshot(name);
  };
  settled("whole");
  window.key("shift+c");
  window.waitForValue("image/cut_coronal", "without the front");
  settled("without_front");
  CHECK(window.differingPixels("whole", "without_front") > 500);
  window.key("shift+c");
  window.waitForValue("image/cut_coronal", "without the back");
  settled("without_back");
  CHECK(window.differingPixels("without_front", "without_back") > 500);
  window.key("shift+c");
  window.waitForValue("image/cut_coronal", "whole");
  window.click("menu/view");
  window.click("menu/view.cut_axial");
  window.waitForValue("image/cut_axial", "without what is above");
  window.click("image/cut_sagittal");
  window.click("image/cut_sagittal.option.without the left");
  window.waitForValue("image/cut_sagittal", "without the left");
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  settled("corner");
  CHECK(window.differingPixels("whole", "corner") > 500);
  // The cut follows the slice.
  window.moveTo(inPane(window, "axial", 0.5, 0.5));
  window.wheel(-5);
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  settled("lower");
  CHECK(window.differingPixels("corner", "lower") > 500);
}

TEST_CASE("a file that cannot be read leads to a message, and the image stays", "[image_bad_file]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_bad_file");
  const fs::path bad = outputFile("image_bad_file_broken.nii");
  std::ofstream(bad, std::ios::binary) << "this is no image";
  startOn(window, {imageFile("image_bad_file").string(), bad.string()});
  const Json state = C3DE_WAIT(window, "the message", s["notifications"].size() == 1);
  CHECK_THAT(state["notifications"][0]["title"].get<std::string>(), Contains("image_bad_file_broken.nii"));
  CHECK(state["notifications"][0]["severity"] == "error");
  CHECK(state["panes"].size() == 4);
}

TEST_CASE("of several files each that cannot be used says why, and the others are opened", "[image_several]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_several");
  const fs::path notes = outputFile("image_several_notes.xyz"), far = outputFile("image_several_far.nrrd");
  std::ofstream(notes) << "a shopping list";
  c3de::imaging::LabelMap map;
  map.geometry = {{4, 4, 4}, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 900, 0, 0, 1}};
  map.voxels.assign(64, 1);
  REQUIRE(c3de::imaging::writeLabelMap(far, map));
  startOn(window, {imageFile("image_several").string(), notes.string(),
                   (fs::path(testResourcesFolder()) / "meshes" / "organ.obj").string(), far.string()});
  const Json state = C3DE_WAIT(window, "both messages and the organ",
                               s["notifications"].size() == 2 && s["transport"]["exists"].get<bool>());
  std::string all;
  for (const Json &n : state["notifications"])
    all += n["title"].get<std::string>() + ": " + n["text"].get<std::string>() + "\n";
  CHECK_THAT(all,
             Contains("image_several_notes.xyz: is not a supported file") && Contains("does not overlap the image"));
  CHECK(state["panes"].size() == 4);
}

TEST_CASE("an organ is cut by the slices and can be pulled in the 3D view beside them", "[image_organ]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_organ");
  const fs::path scene = outputFile("image_organ.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Organ in an image\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 5.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \""
      << (fs::path(testResourcesFolder()) / "meshes" / "organ.obj").generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.4, density = 1000.0 }\n"
      << "sampling = { count = 400 }\n";
  startOn(window, {imageFile("image_organ").string(), scene.string()});
  C3DE_WAIT(
      window, "the organ is cut by all slices",
      number(s, "axial.outlines") >= 1 && number(s, "sagittal.outlines") >= 1 && number(s, "coronal.outlines") >= 1);
  // the planes would hide the organ from the mouse
  window.click("scene/" + imageFile("image_organ").filename().string());
  window.moveTo(inPane(window, "3D", 0.5, 0.5));
  window.key("f");
  window.screenshot("rest");
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
  window.key("space");
  window.moveTo(inPane(window, "3D", 0.5, 0.5));
  window.press();
  const auto held = [](const Json &s) { return s["values"].value("pointbased.controller/Held surfel", std::string()); };
  C3DE_WAIT(window, "a surfel is held", !held(s).empty() && held(s) != "–");
  for (int i = 1; i <= 6; ++i) window.moveTo(inPane(window, "3D", 0.5 + 0.05 * i, 0.5 - 0.04 * i));
  C3DE_WAIT(window, "the hand pulls",
            std::strtod(s["values"].value("pointbased.controller/Pinch force", std::string()).c_str(), nullptr) > 0.0);
  window.waitFrames(10);
  window.screenshot("pulled");
  window.release();
  CHECK(window.differingPixels("rest", "pulled") > 100);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("implants, instruments and jaws are cut by the slices, as they move", "[image_rigid]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_rigid");
  std::ofstream(outputFile("image_rigid_plate.obj"))
      << "v -40 56 -20\nv -40 56 20\nv -40 64 -20\nv -40 64 20\nv 40 56 -20\nv 40 56 20\nv 40 64 -20\nv 40 64 20\n"
         "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n";
  const fs::path scene = outputFile("image_rigid.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Rigid in an image\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 20.0\n"
         "[[body]]\nname = \"organ\"\nmesh = \""
      << (fs::path(testResourcesFolder()) / "meshes" / "organ.obj").generic_string()
      << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
         "sampling = { count = 400 }\n"
         "[[attachment]]\nbodies = [\"organ\", \"surroundings\"]\nstiffness = 5e4\n"
         "[[obstacle]]\nname = \"plate\"\nmesh = \"image_rigid_plate.obj\"\nmesh_unit = \"mm\"\n"
         "[[grasp]]\nname = \"forceps\"\nat = [0, 0, 0.05]\naxis = [1, 0, 0]\njaw_mm = 30\nclosed_mm = 55\n";
  startOn(window, {imageFile("image_rigid").string(), scene.string()});
  const auto outlines = [](const std::string &pane, int count) {
    return [key = pane + ".outlines", count](const Json &s) { return number(s, key) == count; };
  };
  // Of the organ, and of the plate where its plane intersects it: it is behind the coronal one.
  window.waitUntil("organ and plate are cut", outlines("axial", 2));
  CHECK(number(window.state(), "sagittal.outlines") == 2);
  CHECK(number(window.state(), "coronal.outlines") == 1);
  window.screenshot("behind");
  window.click("scene/" + imageFile("image_rigid").filename().string());
  window.moveTo(inPane(window, "3D", 0.5, 0.5));
  window.key("f");
  window.key("m");
  const std::string panel = "pointbased.controller/";
  window.click(panel + "placed");
  window.click(panel + "placed.option.plate");
  const auto typed = [&](const std::string &widget, const std::string &value) {
    window.controlClick(panel + widget);
    window.key("ctrl+a");
    window.type(value);
    window.key("Return");
  };
  typed("placed_z", "70");
  window.waitUntil("the plate has left the axial slice", outlines("axial", 1));
  typed("placed_y", "0");
  window.waitUntil("it has come into the coronal one", outlines("coronal", 2));
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  window.screenshot("moved");
  CHECK(window.differingPixels("behind", "moved", "coronal") > 50);

  // Jaws grasp at the first step.
  window.key("space");
  window.waitUntil("both jaws are cut", outlines("coronal", 4));
  // The instrument, on the far side of the organ.
  window.moveTo(inPane(window, "3D", 0.5, 0.5));
  window.key("t");
  C3DE_WAIT(window, "the touch tool is active", s["tool"] == "pointbased.touch");
  window.moveTo(inPane(window, "3D", 0.4, 0.5));
  window.press();
  C3DE_WAIT(window, "an instrument is there",
            s["values"].value(panel + "Contact area", std::string()).ends_with("mm²"));
  window.release();
  typed("touch_x", "-75");
  typed("touch_z", "0");
  typed("touch_y", "0");
  window.waitUntil("the instrument is cut", outlines("axial", 2));
  window.waitUntil("in both slices", outlines("coronal", 5));
  window.moveTo(inPane(window, "3D", 0.9, 0.9));
  window.screenshot("all");
  CHECK(window.differingPixels("moved", "all", "axial") > 20);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("an image moves with its body, stands where it stands and goes back with it", "[image_warp]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_warp");
  const fs::path scene = outputFile("image_warp.toml");
  const std::string image = imageFile("image_warp").generic_string();
  // A free block that flies 4 mm in a second of simulation, shown in its own image.
  constexpr double kSpeed_mm_s = 4.0;
  std::ofstream(scene) << "format = 1\ntitle = \"Flying\"\n[image]\nfile = \"" << image << "\"\nrim = 8\n"
                       << "[world]\ngravity = [0, 0, 0]\n[solver]\ndamping = 0\n[[body]]\nname = \"block\"\nvolume = \""
                       << image
                       << "\"\nthreshold = [-480, 10000]\nvelocity = [0.004, 0, 0]\nsampling = { count = 300 }\n";
  startOn(window, {scene.string()});
  const auto shift_mm = [](const Json &s) {
    const std::string readout = text(s, "axial.readout");
    const std::size_t at = readout.find("|u| ");
    return at == std::string::npos ? -1.0 : std::strtod(readout.c_str() + at + 4, nullptr);
  };
  C3DE_WAIT(window, "the image knows its displacement", shift_mm(s) == 0.0);
  window.screenshot("rest");
  window.key("space");
  C3DE_WAIT(window, "it flies", s["transport"]["time_s"] > 0.8);
  window.key("space");
  // At the end the displacement belongs to the displayed time; the read-out has two decimals.
  C3DE_WAIT(window, "it stands",
            s["transport"]["mode"] == "paused" &&
                std::abs(shift_mm(s) - kSpeed_mm_s * s["transport"]["time_s"].get<double>()) < 0.011);
  window.screenshot("flown");
  CHECK(window.differingPixels("rest", "flown") > 500);

  // The displayed image can be exported, by the menu.
  const auto save = [&](const std::string &entry, const fs::path &file) {
    fs::remove(file);
    window.click("menu/file");
    C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/" + entry));
    window.click("menu/" + entry);
    window.enterFile(file);
    C3DE_WAIT(window, "it is written", s["notifications"].size() == 1);
    CHECK(window.state()["notifications"][0]["title"] == "Exported");
    CHECK_THAT(window.state()["notifications"][0]["text"].get<std::string>(), Contains(file.filename().string()));
    window.click("notification/close.0");
    C3DE_WAIT(window, "the message is closed", s["notifications"].empty());
  };
  const fs::path seen = outputFile("image_warp_seen.nii.gz"), field = outputFile("image_warp_u.nrrd");
  save("file.export_image", seen);
  save("file.export_displacement", field);
  const auto before = c3de::imaging::readVolume(image), after = c3de::imaging::readVolume(seen);
  REQUIRE(before);
  REQUIRE(after);
  const auto middle = [](const c3de::imaging::Volume &v) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < v.geometry.size[2]; ++k)
      for (std::size_t j = 0; j < v.geometry.size[1]; ++j)
        for (std::size_t i = 0; i < v.geometry.size[0]; ++i) {
          // By brightness above the surroundings: faces between voxels count in part.
          const double bright = std::max(0.0, v.value(i, j, k) - v.value(0, 0, 0));
          sum +=
              bright * v.geometry.worldAt({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})[0];
          count += bright;
        }
    return sum / count;
  };
  const double flown_mm = kSpeed_mm_s * window.state()["transport"]["time_s"].get<double>();
  // Voxels of 2 mm belong to the block or not: its two faces jump from one to the next, half a voxel behind and ahead
  // of the tissue in turn. Measured over 1.6 … 6.4 mm: a saw tooth of ±0.53 mm.
  CHECK(middle(after->volume) - middle(before->volume) == Approx(flown_mm).margin(0.6));
  CHECK(fs::file_size(field) > 1000);
  window.moveTo(inPane(window, "3D", 0.5, 0.9));  // over a slice the key is the slice's
  window.key("ctrl+r");
  C3DE_WAIT(window, "it is back", s["transport"]["time_s"] == 0.0 && shift_mm(s) == 0.0);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("an image follows its body far from where it began", "[image_warp_far]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("image_warp_far");
  const fs::path scene = outputFile("image_warp_far.toml");
  const std::string image = imageFile("image_warp_far").generic_string();
  constexpr double kSpeed_mm_s = 45.0;
  // The block extends from -30 to 30 mm. A rim of 8 mm, a spacing of about 9 mm and a margin of 9 mm: the first grid
  // ends at 56.
  const Vec3 place{65, 0, 0};
  std::ofstream(scene) << "format = 1\ntitle = \"Flying far\"\n[image]\nfile = \"" << image << "\"\nrim = 8\n"
                       << "[world]\ngravity = [0, 0, 0]\n[solver]\ndamping = 0\n[[body]]\nname = \"block\"\nvolume = \""
                       << image
                       << "\"\nthreshold = [-480, 10000]\nvelocity = [0.045, 0, 0]\nsampling = { count = 300 }\n";
  startOn(window, {scene.string()});
  const auto shift_mm = [](const Json &s) {
    const std::string readout = text(s, "coronal.readout");
    const std::size_t at = readout.find("|u| ");
    return at == std::string::npos ? -1.0 : std::strtod(readout.c_str() + at + 4, nullptr);
  };
  C3DE_WAIT(window, "the image knows its displacement", shift_mm(s) == 0.0);
  window.clickAt(pixelOf(window, "axial", place));
  C3DE_WAIT(window, "the cross-hair is there", std::abs(crossHair(s)[0] - place[0]) < 2.0);
  CHECK_THAT(text(window.state(), "coronal.readout"), Contains("   -1000"));
  window.click("image/overlay");
  window.click("image/overlay.option.|u|");
  window.waitForValue("image/overlay", "|u|");
  window.moveTo(inPane(window, "3D", 0.5, 0.9));  // over a slice the keys are the slice's
  window.screenshot("rest");
  window.key("space");
  C3DE_WAIT(window, "it is far away", s["transport"]["time_s"] > 1.1);
  window.key("space");
  const Json flown =
      C3DE_WAIT(window, "it stands",
                s["transport"]["mode"] == "paused" &&
                    std::abs(shift_mm(s) - kSpeed_mm_s * s["transport"]["time_s"].get<double>()) < 0.011);
  CHECK_THAT(text(flown, "coronal.readout"), !Contains("   -1000"));
  window.screenshot("flown");
  CHECK(window.differingPixels("rest", "flown") > 500);
  window.key("ctrl+r");
  C3DE_WAIT(window, "it is back", s["transport"]["time_s"] == 0.0 && shift_mm(s) == 0.0);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("a folder of several series asks for one, and for none", "[image_series]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(folder, "dicom/mr_mixed_orientation_4");
  WorkstationDriver window("image_series");
  window.start({folder.string()});
  const auto isAsked = [](const Json &s) { return s["jobs"].empty() && s["widgets"].contains("series/series.1"); };
  window.waitUntil("a series is asked for", isAsked);
  CHECK(window.state()["panes"].empty());
  // In the view, where the picture is going to be, and no other request is shown there.
  const Json asked = window.state();
  CHECK(asked["widgets"]["series/series.1"][0].get<double>() > asked["area"]["x"].get<double>());
  window.screenshot("asked");
  window.click("series/series.1");
  C3DE_WAIT(window, "the series is shown", s["panes"].size() == 4 && s["jobs"].empty());
  CHECK_FALSE(window.state()["widgets"].contains("series/series.0"));

  WorkstationDriver other("image_series_none");
  other.start({folder.string()});
  other.waitUntil("a series is asked for", isAsked);
  other.click("series/cancel");
  C3DE_WAIT(other, "the question is gone", !s["widgets"].contains("series/series.1"));
  CHECK(other.state()["panes"].empty());
}

TEST_CASE("a segmentation that is opened as an image is a label map", "[image_segmentation]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(segments, "dicom/ct_3slice_plus_seg/liver.dcm");
  C3DE_DATA_OR_SKIP(scan, "dicom/ct_3slice_plus_seg/01.dcm");
  // Alone: over its own numbers.
  for (const fs::path &file : {segments, labelFile("image_segmentation", ".seg.nrrd")}) {
    WorkstationDriver alone("image_segmentation" + file.extension().string());
    alone.start({file.string()});
    const Json state = C3DE_WAIT(alone, "its labels are there",
                                 s["panes"].size() == 4 && s["jobs"].empty() && !text(s, "Label map").empty());
    CHECK(text(state, "Label map") == file.filename().string());
    std::string all;
    for (const Json &n : state["notifications"]) all += n["text"].get<std::string>() + "\n";
    CHECK_THAT(all, Contains("Its segments lie over its numbers as labels"));
  }
  // Over a scan, which remains.
  WorkstationDriver window("image_segmentation_scan");
  startOn(window, {scan.string()});
  const std::string shown = text(window.state(), "Image");
  window.key("ctrl+i");
  C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
  window.click("dialog/path");
  window.key("ctrl+a");
  window.type(segments.string());
  window.key("Return");
  const Json state = C3DE_WAIT(window, "its labels are there", s["jobs"].empty() && !text(s, "Label map").empty());
  CHECK(text(state, "Image") == shown);
  CHECK(text(state, "Label map") == "liver.dcm");
  std::string all;
  for (const Json &n : state["notifications"]) all += n["text"].get<std::string>() + "\n";
  CHECK_THAT(all, Contains("lie over the image that is open, as labels"));
}
