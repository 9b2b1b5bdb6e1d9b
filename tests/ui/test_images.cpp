// SPDX-License-Identifier: Apache-2.0
// User actions with an image in the window: scroll, point, change window and level, maximise, overlay labels, cut.
#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "c3de/core/vec.h"
#include "support/catch.h"
#include "ui/image_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

TEST_CASE("slices scroll by wheel and keys, each view by itself", "[image_scroll]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_scroll");
  startOn(window, {imageFile("image_scroll").string()});
  const Json first = window.state();
  CHECK(first["view"] == first["panes"]["3D"]);
  CHECK(imageText(first, "axial.letters") == "R|L|A|P");
  CHECK(imageText(first, "sagittal.letters") == "A|P|S|I");
  CHECK(imageText(first, "coronal.letters") == "R|L|S|I");
  const double axial = imageNumber(first, "axial.slice"), coronal = imageNumber(first, "coronal.slice");
  const auto waitForSlice = [&](const char *pane, double slice) {
    return C3DE_WAIT(window, "the slice changes", imageNumber(s, std::string(pane) + ".slice") == slice);
  };
  window.moveTo(window.inPane("axial", 0.3, 0.4));
  window.wheel(3);
  waitForSlice("axial", axial + 3);
  window.key("b");
  waitForSlice("axial", axial + 2);
  window.key("shift+Up");
  waitForSlice("axial", axial + 12);
  window.key("Left");
  const Json later = waitForSlice("axial", axial + 11);
  CHECK(imageNumber(later, "coronal.slice") == coronal);
  CHECK(later["transport"]["steps"] == 0);
  window.moveTo(window.inPane("coronal", 0.3, 0.4));
  window.key("f");
  waitForSlice("coronal", coronal + 1);
  window.screenshot("scrolled");
}

TEST_CASE("modifiers count for the wheel and the mouse as they are held, not one event later", "[image_modifiers]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_modifiers");
  startOn(window, {imageFile("image_modifiers").string()});
  const double first = imageNumber(window.state(), "axial.slice"),
               scale = imageNumber(window.state(), "axial.scale_mm_per_px");
  window.moveTo(window.inPane("axial", 0.3, 0.4));
  window.keyDown("ctrl");
  window.wheel(1);
  const Json zoomed =
      C3DE_WAIT(window, "it zooms or scrolls",
                imageNumber(s, "axial.scale_mm_per_px") != scale || imageNumber(s, "axial.slice") != first);
  CHECK(imageNumber(zoomed, "axial.slice") == first);
  const double closer = imageNumber(zoomed, "axial.scale_mm_per_px");
  CHECK(closer < scale);
  window.keyUp("ctrl");
  window.wheel(1);
  const Json scrolled =
      C3DE_WAIT(window, "it scrolls or zooms",
                imageNumber(s, "axial.scale_mm_per_px") != closer || imageNumber(s, "axial.slice") != first);
  CHECK(imageNumber(scrolled, "axial.slice") == first + 1);
  CHECK(imageNumber(scrolled, "axial.scale_mm_per_px") == closer);
  window.keyDown("shift");
  window.wheel(1);
  C3DE_WAIT(window, "ten slices", imageNumber(s, "axial.slice") == first + 11);
  window.keyUp("shift");
  window.wheel(-1);
  C3DE_WAIT(window, "one slice", imageNumber(s, "axial.slice") == first + 10);
  // Shift and a move set the cross-hair, a move without it does not.
  const Vec3 before = crossHairOf(window.state());
  window.keyDown("shift");
  window.moveTo(window.inPane("axial", 0.4, 0.6));
  const Json pointed = C3DE_WAIT(window, "the cross-hair follows", norm(crossHairOf(s) - before) > 1.0);
  window.keyUp("shift");
  window.moveTo(window.inPane("axial", 0.6, 0.45));
  window.waitFrames(0);
  CHECK(norm(crossHairOf(window.state()) - crossHairOf(pointed)) < 1e-9);
}

TEST_CASE("R is the reset of the view under the mouse, and Ctrl+R that of the simulation", "[image_reset]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_reset");
  startOn(window, {imageFile("image_reset").string()});
  const Json first = window.state();
  window.moveTo(window.inPane("axial", 0.3, 0.4));
  window.wheel(3);
  window.moveTo(window.inPane("coronal", 0.3, 0.4));
  window.wheel(2);
  C3DE_WAIT(window, "both have scrolled",
            imageNumber(s, "axial.slice") == imageNumber(first, "axial.slice") + 3 &&
                imageNumber(s, "coronal.slice") == imageNumber(first, "coronal.slice") + 2);
  window.key("r");
  C3DE_WAIT(window, "this one is as at the start",
            imageNumber(s, "coronal.slice") == imageNumber(first, "coronal.slice"));
  CHECK(imageNumber(window.state(), "axial.slice") == imageNumber(first, "axial.slice") + 3);
  window.drag(window.inPane("3D", 0.5, 0.5), window.inPane("3D", 0.7, 0.6), 3);
  REQUIRE(window.state()["camera"]["yaw"] != first["camera"]["yaw"]);
  window.key("r");
  C3DE_WAIT(window, "the camera is as at the start",
            s["camera"]["yaw"] == first["camera"]["yaw"] && s["camera"]["pitch"] == first["camera"]["pitch"]);
  CHECK(imageNumber(window.state(), "axial.slice") == imageNumber(first, "axial.slice") + 3);
  // The hint describes the action of the mouse at its position.
  CHECK_THAT(window.value("status/hint"), Contains("orbit"));
  window.moveTo(window.inPane("axial", 0.3, 0.4));
  window.waitUntil("the hint is that of slices", [](const Json &s) {
    const std::string hint = s["values"].value("status/hint", "");
    return hint.find("cross-hair") != std::string::npos && hint.find("orbit") == std::string::npos;
  });
}

TEST_CASE("a click sets the cross-hair in all views, and the read-out tells what is there", "[image_cross_hair]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_cross_hair");
  startWithLabels(window, "image_cross_hair");
  // The stem of the L: x = 23, y = -6, z = 0.
  window.clickAt(pixelOf(window, "coronal", {23, 0, 0}));
  window.clickAt(pixelOf(window, "sagittal", {0, -6, 0}));
  const Json state = C3DE_WAIT(window, "the cross-hair is there", norm(crossHairOf(s) - Vec3{23, -6, 0}) < 2.0);
  for (const char *pane : {"axial", "sagittal", "coronal"})
    CHECK(imageText(state, std::string(pane) + ".cross_hair") == "shown");
  // The mouse is over the sagittal view; the others read at the cross-hair.
  CHECK_THAT(imageText(state, "axial.readout"), Contains("   700") && Contains("letters") && Contains("mm"));
  window.screenshot("on_the_L");
  window.moveTo(window.inPane("axial", 0.2, 0.2));
  C3DE_WAIT(window, "the read-out follows the mouse", imageText(s, "axial.readout").find("-1000") != std::string::npos);
  window.wheel(-2);
  C3DE_WAIT(window, "it is not on that slice", imageText(s, "axial.cross_hair") == "hidden");
  CHECK(imageText(window.state(), "coronal.cross_hair") == "shown");
  CHECK(norm(crossHairOf(window.state()) - crossHairOf(state)) < 1e-9);
  window.key("c");
  C3DE_WAIT(window, "it is switched off", imageText(s, "coronal.cross_hair") == "hidden");
}

TEST_CASE("window and level follow a drag in their own mode, and number keys are presets", "[image_window]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_window");
  startOn(window, {imageFile("image_window").string()});
  const Json first = window.state();
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.key("w");
  window.drag(window.inPane("axial", 0.3, 0.7), window.inPane("axial", 0.6, 0.3), 4);
  const Json dragged = window.state();
  CHECK(imageNumber(dragged, "window") > imageNumber(first, "window"));
  CHECK(imageNumber(dragged, "level") < imageNumber(first, "level"));
  CHECK(norm(crossHairOf(dragged) - crossHairOf(first)) < 1e-9);
  window.screenshot("dragged");
  window.key("3");
  C3DE_WAIT(window, "bone", imageNumber(s, "window") == 2000.0 && imageNumber(s, "level") == 400.0);
  window.key("0");
  C3DE_WAIT(window, "automatic", imageNumber(s, "window") == imageNumber(first, "window"));
  // In the 3D view the same key is a direction.
  window.moveTo(window.inPane("3D", 0.5, 0.5));
  window.key("3");
  C3DE_WAIT(window, "the camera has turned", s["camera"]["yaw"] != first["camera"]["yaw"]);
  CHECK(imageNumber(window.state(), "window") == imageNumber(first, "window"));
  window.click("toolbar/slices.cross_hair");
  window.clickAt(window.inPane("axial", 0.4, 0.4));
  CHECK(norm(crossHairOf(window.state()) - crossHairOf(first)) > 1.0);
}

TEST_CASE("a double click gives a view the whole area, and another one gives it back", "[image_maximise]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_maximise");
  startOn(window, {imageFile("image_maximise").string()});
  const Json four = window.state();
  // The cross-hair never leaves the image: outside, the nearest point of the image is used.
  window.clickAt(window.inPane("axial", 0.02, 0.5));
  const Json clicked = C3DE_WAIT(window, "the click is taken", norm(crossHairOf(s) - crossHairOf(four)) > 1.0);
  CHECK(crossHairOf(clicked)[0] == Approx(-80.0).margin(1e-3));  // the image ends there
  CHECK_THAT(imageText(clicked, "coronal.readout"), Contains("["));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  // A double click changes only the views.
  window.doubleClickAt(window.inPane("axial", 0.8, 0.03));
  const Json onlyAxial = C3DE_WAIT(window, "one view", s["panes"].size() == 1);
  CHECK(crossHairOf(onlyAxial) == crossHairOf(clicked));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  window.doubleClickAt(window.inPane("axial", 0.7, 0.2));
  const Json fourAgain = C3DE_WAIT(window, "four views", s["panes"].size() == 4);
  CHECK(crossHairOf(fourAgain) == crossHairOf(clicked));
  for (const char *pane : {"axial", "sagittal", "coronal"})
    CHECK(imageNumber(fourAgain, std::string(pane) + ".slice") == imageNumber(clicked, std::string(pane) + ".slice"));
  std::this_thread::sleep_for(std::chrono::milliseconds(450));
  for (const char *pane : {"coronal", "3D"}) {
    window.doubleClickAt(window.inPane(pane, 0.4, 0.4));
    const Json one = C3DE_WAIT(window, "one view", s["panes"].size() == 1 && s["panes"].contains(pane));
    CHECK(one["panes"][pane]["w"] > 1.9 * four["panes"][pane]["w"].get<double>());
    window.screenshot(std::string("only_") + pane);
    // Clicks in quicker succession than a double click count as triple or quadruple clicks.
    std::this_thread::sleep_for(std::chrono::milliseconds(450));
    window.doubleClickAt(window.inPane(pane, 0.4, 0.4));
    const Json back = C3DE_WAIT(window, "four views", s["panes"].size() == 4);
    CHECK(back["panes"] == four["panes"]);
    std::this_thread::sleep_for(std::chrono::milliseconds(450));
  }
  // Closed, the window is as without an image.
  window.clickMenu("file.close_image");
  const Json closed = window.waitUntil("the image is closed", [](const Json &s) {
    return s["panes"].empty() && s["view"]["w"] > 600 && !s["widgets"].contains("image/header");  // a frame later
  });
  CHECK(closed["nodes"].empty());
}

TEST_CASE("a view shows what has changed in it at once, and no more than that", "[image_kept]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_kept");
  startWithLabels(window, "image_kept");
  const auto shot = [&](const char *name) {
    window.moveTo(window.inPane("3D", 0.9, 0.9));
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
  window.doubleClickAt(window.inPane("axial", 0.5, 0.5));
  window.waitForValue("image/layout", "axial");
  window.screenshot("alone");
  window.doubleClickAt(window.inPane("axial", 0.5, 0.5));
  window.waitForValue("image/layout", "four");
  shot("four_again");
  differ("first", "four_again", {});
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.wheel(3);
  C3DE_WAIT(window, "another slice", imageNumber(s, "axial.slice") == 27.0);
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
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.key("4");
  shot("preset");
  differ("with_block", "preset", all);
  window.drag(window.inPane("3D", 0.4, 0.5), window.inPane("3D", 0.6, 0.6), 4);
  shot("turned");
  differ("preset", "turned", {"3D"});
  window.click("scene/" + imageFile("image_kept").filename().string());
  shot("hidden");
  differ("turned", "hidden", {"3D"});
}

TEST_CASE("volume rendering, presets and labels are chosen in the panel", "[image_panel]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("image_panel");
  startWithLabels(window, "image_panel");
  window.screenshot("before");
  window.click("image/volume");
  window.waitForValue("image/volume", "true");
  window.moveTo(window.inPane("3D", 0.9, 0.9));
  window.screenshot("volume");
  CHECK(window.differsFrom("before", "volume", 500));
  window.choose("image/volume_preset", "MIP");
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
  window.choose("image/volume_preset", "CT soft tissue");
  window.moveTo(window.inPane("3D", 0.9, 0.9));
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
  window.clickMenu("view.cut_axial");
  window.waitForValue("image/cut_axial", "without what is above");
  window.choose("image/cut_sagittal", "without the left");
  window.waitForValue("image/cut_sagittal", "without the left");
  window.moveTo(window.inPane("3D", 0.9, 0.9));
  settled("corner");
  CHECK(window.differingPixels("whole", "corner") > 500);
  // The cut follows the slice.
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.wheel(-5);
  window.moveTo(window.inPane("3D", 0.9, 0.9));
  settled("lower");
  CHECK(window.differingPixels("corner", "lower") > 500);
}
