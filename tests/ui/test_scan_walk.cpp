// SPDX-License-Identifier: Apache-2.0
// The complete workflow of a user with a CT: window by key, cross-hair by mouse, threshold, organ, simulation, a pull
// at it, and the scan that follows. The single steps are in test_images.cpp and test_segmentation.cpp.
#include <cmath>
#include <filesystem>
#include <sstream>

#include "c3de/core/vec.h"
#include "support/catch.h"
#include "ui/workstation_driver.h"

using namespace c3de;  // operators of Vec3
using c3de::test::Json;
using c3de::test::Point;
using c3de::test::WorkstationDriver;

namespace {

std::string text(const Json &state, const std::string &key) { return state["values"].value(key, std::string()); }

double number(const Json &state, const std::string &key) {
  return std::strtod(state["values"].value(key, std::string("nan")).c_str(), nullptr);
}

Vec3 crossHair(const Json &state) {
  Vec3 at{};
  std::istringstream(text(state, "image/cross_hair")) >> at[0] >> at[1] >> at[2];
  return at;
}

/// In the initial axial or coronal view: the centre of the image in the middle of the pane, radiological.
Point pixelOf(const WorkstationDriver &window, const std::string &pane, const Vec3 &centre, const Vec3 &world) {
  const Json state = window.state(), r = state["panes"][pane];
  const double scale = number(state, "image/" + pane + ".scale_mm_per_px");
  const Vec3 d = world - centre;
  return {r["x"].get<double>() + 0.5 * r["w"].get<double>() + d[0] / scale,
          r["y"].get<double>() + 0.5 * r["h"].get<double>() + (pane == "axial" ? d[1] : -d[2]) / scale};
}

/// |u| of the read-out of a view at the cross-hair, mm; NaN if there is none.
double shift_mm(const Json &state, const std::string &pane) {
  const std::string readout = text(state, "image/" + pane + ".readout");
  const std::size_t at = readout.find("|u| ");
  return at == std::string::npos ? std::nan("") : std::strtod(readout.c_str() + at + 4, nullptr);
}

/// Moves the cross-hair by the mouse, from `centre` to `target`. A pixel of these views is about 1 mm.
Json pointAt(WorkstationDriver &window, const Vec3 &centre, const Vec3 &target) {
  window.clickAt(pixelOf(window, "coronal", centre, {target[0], centre[1], target[2]}));
  C3DE_WAIT(window, "the height is set", std::abs(crossHair(s)[2] - target[2]) < 2.0);
  window.clickAt(pixelOf(window, "axial", centre, target));
  return C3DE_WAIT(window, "the cross-hair is in the organ", norm(crossHair(s) - target) < 3.0);
}

/// The material of the same name follows.
void nameOrgan(WorkstationDriver &window, const char *name) {
  window.click("segmentation/name");
  window.key("ctrl+a");
  window.type(name);
  window.key("Return");
  window.waitForValue("segmentation/material", name);
}

/// In the 3D view from the front, without the planes of the slices, which would obstruct the mouse.
void takePinchTool(WorkstationDriver &window) {
  // Closing the message has moved the panel, possibly under the mouse.
  for (int tries = 0; tries < 5 && window.value("image/slices_in_space") != "false"; ++tries) {
    window.click("image/slices_in_space");
    window.waitFrames(5);
  }
  window.moveTo(window.inView(0.5, 0.5));
  window.key("1");
  window.key("f");
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
}

/// Presses at the position of the mouse.
Json pinch(WorkstationDriver &window) {
  window.press();
  return window.waitUntil("a surfel is held", [](const Json &s) {
    const std::string held = text(s, "pointbased.controller/Held surfel");
    return !held.empty() && held != "–";
  });
}

}  // namespace

TEST_CASE("a liver is found in a CT by threshold, becomes a body, and the scan follows when it is pulled",
          "[image_walk]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  WorkstationDriver window("image_walk");
  window.start({image.string()});
  const Json first = C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  const Vec3 centre = crossHair(first);
  CHECK(norm(centre - Vec3{-3.544, -161.319, 260.802}) < 2.7);  // `c3de info`; half a voxel's diagonal is 2.6 mm

  // The preset by its key.
  window.moveTo(pixelOf(window, "coronal", centre, centre));
  window.key("4");
  C3DE_WAIT(window, "the preset is set",
            text(s, "image/preset") == "CT abdomen (4)" && number(s, "image/window") == 400.0 &&
                number(s, "image/level") == 50.0);

  const Vec3 liver{-66.5, -185.0, 392.0};
  const Json pointed = pointAt(window, centre, liver);
  const std::string readout = text(pointed, "image/coronal.readout");
  INFO(readout);
  CHECK(readout.find("mm") != std::string::npos);
  window.screenshot("pointed");

  // Threshold, voxels of noise within filled, bridges to bowel and wall removed, the clicked component.
  const auto enter = [&](const char *field, const char *value) {
    window.controlClick(field);
    window.key("ctrl+a");
    window.type(value);
    window.key("Return");
  };
  const auto picked = [](const Json &s) { return number(s, "segmentation/Picked"); };
  const auto settled = [&](const char *what, const auto &isMet) {
    return C3DE_WAIT(window, what, s["jobs"].empty() && isMet(picked(s)));
  };
  enter("segmentation/low", "20");
  enter("segmentation/high", "100");
  C3DE_WAIT(window, "both ends count", text(s, "segmentation/Steps") == "threshold 20 … 100");
  const double between = picked(settled("soft tissue is picked", [](double ml) { return ml > 3000.0; }));
  CHECK(window.value("image/preview") == "shown");
  window.moveTo(pixelOf(window, "axial", centre, liver));
  window.screenshot("threshold");
  window.click("segmentation/fill_holes");
  const double filled = picked(settled("holes are filled", [&](double ml) { return ml > 1.02 * between; }));
  enter("segmentation/radius", "9");
  window.click("segmentation/open");
  const double opened = picked(settled("bridges are removed", [&](double ml) { return ml < 0.9 * filled; }));
  window.click("segmentation/component");
  C3DE_WAIT(window, "a click is waited for", text(s, "image/picking") == "on");
  window.clickAt(pixelOf(window, "axial", centre, liver));
  const double organ = picked(settled("a part is picked", [&](double ml) { return ml < 0.95 * opened; }));
  // The label of the liver in this scan has 1126 ml; threshold and opening retain most of it.
  CHECK(organ > 700.0);
  CHECK(organ < 1240.0);

  nameOrgan(window, "liver");
  // Unsupported, it moves far enough to leave its initial region.
  window.click("segmentation/held");
  window.click("segmentation/held.option.nothing");
  window.waitForValue("segmentation/held", "nothing");
  window.screenshot("organ");
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created",
            s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["time_s"] > 0.2 &&
                number(s, "image/axial.outlines") >= 1 && number(s, "image/coronal.outlines") >= 1);

  window.click("notification/close.0");
  takePinchTool(window);
  C3DE_WAIT(window, "the scan knows its displacement", shift_mm(s, "coronal") < 0.5);
  window.screenshot("created");
  window.moveTo(window.inView(0.38, 0.4));
  (void)pinch(window);
  for (int i = 1; i <= 8; ++i) window.moveTo(window.inView(0.38 + 0.03 * i, 0.4 + 0.04 * i));
  const Json pulled = C3DE_WAIT(window, "the tissue at the cross-hair has moved", shift_mm(s, "coronal") > 2.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  for (const char *pane : {"axial", "coronal", "3D"}) {
    INFO(pane);
    CHECK(window.differingPixels("created", "pulled", pane) > 300);
  }
  CHECK(number(pulled, "pointbased.controller/Pinch force") > 0.0);
  // Behind the liver, which has moved forwards: the scan does not show it twice.
  window.moveTo(pixelOf(window, "axial", centre, {-85.0, -116.0, liver[2]}));
  C3DE_WAIT(window, "its place is empty",
            text(s, "image/axial.readout").find("vacated by a body") != std::string::npos);
  window.release();
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  window.key("ctrl+r");
  C3DE_WAIT(window, "the scan is as it was read", s["transport"]["time_s"] == 0.0 && shift_mm(s, "coronal") == 0.0);
}

TEST_CASE("an organ of a CT that is pulled by three centimetres and let go comes back, and nothing smears",
          "[image_returns]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  WorkstationDriver window("image_returns");
  window.start({image.string(), labels.string()});
  const Json first = C3DE_WAIT(window, "the scan and its labels are shown",
                               s["panes"].size() == 4 && s["jobs"].empty() && !text(s, "image/Label map").empty());
  const Vec3 centre = crossHair(first);
  window.moveTo(pixelOf(window, "coronal", centre, centre));
  window.key("4");

  // The spleen, as in the labels; its supports are the proposed ones.
  window.click("segmentation/label_filter");
  window.type("spleen");
  window.click("segmentation/label.1");
  C3DE_WAIT(window, "it is picked", text(s, "segmentation/Picked").starts_with("261"));
  nameOrgan(window, "spleen");
  CHECK(window.value("segmentation/held") == "by its surroundings");
  CHECK(window.number("segmentation/surroundings") == 30000.0);
  (void)window.locate("segmentation/surroundings");
  window.screenshot("held");
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created",
            s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["time_s"] > 0.2 &&
                number(s, "image/axial.outlines") + number(s, "image/coronal.outlines") +
                        number(s, "image/sagittal.outlines") >=
                    0);

  (void)pointAt(window, centre, {95.0, -135.0, 375.0});
  takePinchTool(window);
  C3DE_WAIT(window, "it rests where the scan shows it", shift_mm(s, "axial") < 0.05);
  window.moveTo(window.inView(0.5, 0.5));
  window.waitFrames(5);
  window.screenshot("before");

  const auto millimetres = [](const Json &s, const char *row) {
    Vec3 at{};
    std::istringstream(text(s, std::string("pointbased.controller/") + row)) >> at[0] >> at[1] >> at[2];
    return at;
  };
  const Json held = pinch(window);
  const Vec3 from = millimetres(held, "Held point");
  double u = 0.5, v = 0.5;
  while (norm(millimetres(window.state(), "Hand") - from) < 30.0 && u > 0.05) {
    u -= 0.02;
    v += 0.01;
    window.moveTo(window.inView(u, v));
    window.waitFrames(2);
  }
  CHECK(norm(millimetres(window.state(), "Hand") - from) >= 30.0);
  C3DE_WAIT(window, "the organ gives way", norm(millimetres(s, "Held point") - from) > 5.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  window.release();
  window.moveTo(window.inView(0.5, 0.5));
  C3DE_WAIT(window, "it has come back", shift_mm(s, "axial") < 0.05);
  window.waitFrames(10);
  window.screenshot("returned");
  CHECK(window.differingPixels("before", "pulled", "3D") > 300);
  for (const char *pane : {"axial", "coronal", "sagittal", "3D"}) {
    INFO(pane);
    // Digits of the read-out, 78 to 98 pixels seen; pulled tissue changes thousands.
    CHECK(window.differingPixels("before", "returned", pane) < 250);
  }
}
