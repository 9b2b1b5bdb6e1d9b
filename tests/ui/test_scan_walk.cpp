// SPDX-License-Identifier: Apache-2.0
// The complete workflow of a user with a CT: window by key, cross-hair by mouse, threshold, organ, simulation, a pull
// at it, and the scan that follows. The single steps are in test_images.cpp and test_segmentation.cpp.
#include <cmath>

#include "c3de/core/vec.h"
#include "support/catch.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// In the initial axial or coronal view: the centre of the image in the middle of the pane, radiological.
Point pixelOf(const WorkstationDriver &window, const std::string &pane, const Vec3 &centre, const Vec3 &world) {
  const Vec3 d = world - centre;
  return window.inSlice(pane, d[0], pane == "axial" ? d[1] : -d[2]);
}

/// Moves the cross-hair by the mouse, from `centre` to `target`. A pixel of these views is about 1 mm.
Json pointAt(WorkstationDriver &window, const Vec3 &centre, const Vec3 &target) {
  window.clickAt(pixelOf(window, "coronal", centre, {target[0], centre[1], target[2]}));
  C3DE_WAIT(window, "the height is set", std::abs(vectorOf(s, "image/cross_hair")[2] - target[2]) < 2.0);
  window.clickAt(pixelOf(window, "axial", centre, target));
  return C3DE_WAIT(window, "the cross-hair is in the organ", norm(vectorOf(s, "image/cross_hair") - target) < 3.0);
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
    const std::string held = textOf(s, kPanel + "Held surfel");
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
  const Vec3 centre = vectorOf(first, "image/cross_hair");
  CHECK(norm(centre - Vec3{-3.544, -161.319, 260.802}) < 2.7);  // `c3de info`; half a voxel's diagonal is 2.6 mm

  // The preset by its key.
  window.moveTo(pixelOf(window, "coronal", centre, centre));
  window.key("4");
  C3DE_WAIT(window, "the preset is set",
            textOf(s, "image/preset") == "CT abdomen (4)" && numberOf(s, "image/window") == 400.0 &&
                numberOf(s, "image/level") == 50.0);

  const Vec3 liver{-66.5, -185.0, 392.0};
  const Json pointed = pointAt(window, centre, liver);
  const std::string readout = textOf(pointed, "image/coronal.readout");
  INFO(readout);
  CHECK(readout.find("mm") != std::string::npos);
  window.screenshot("pointed");

  // Threshold, voxels of noise within filled, bridges to bowel and wall removed, the clicked component.
  const auto picked = [](const Json &s) { return numberOf(s, "segmentation/Picked"); };
  const auto settled = [&](const char *what, const auto &isMet) {
    return C3DE_WAIT(window, what, s["jobs"].empty() && isMet(picked(s)));
  };
  window.enterNumber("segmentation/low", "20");
  window.enterNumber("segmentation/high", "100");
  C3DE_WAIT(window, "both ends count", textOf(s, "segmentation/Steps") == "threshold 20 … 100");
  const double between = picked(settled("soft tissue is picked", [](double ml) { return ml > 3000.0; }));
  CHECK(window.value("image/preview") == "shown");
  window.moveTo(pixelOf(window, "axial", centre, liver));
  window.screenshot("threshold");
  window.click("segmentation/fill_holes");
  const double filled = picked(settled("holes are filled", [&](double ml) { return ml > 1.02 * between; }));
  window.enterNumber("segmentation/radius", "9");
  window.click("segmentation/open");
  const double opened = picked(settled("bridges are removed", [&](double ml) { return ml < 0.9 * filled; }));
  window.click("segmentation/component");
  C3DE_WAIT(window, "a click is waited for", textOf(s, "image/picking") == "on");
  window.clickAt(pixelOf(window, "axial", centre, liver));
  const double organ = picked(settled("a part is picked", [&](double ml) { return ml < 0.95 * opened; }));
  // The label of the liver in this scan has 1126 ml; threshold and opening retain most of it.
  CHECK(organ > 700.0);
  CHECK(organ < 1240.0);

  nameOrgan(window, "liver");
  // Unsupported, it moves far enough to leave its initial region.
  window.choose("segmentation/held", "nothing");
  window.waitForValue("segmentation/held", "nothing");
  window.screenshot("organ");
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created",
            s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["time_s"] > 0.2 &&
                numberOf(s, "image/axial.outlines") >= 1 && numberOf(s, "image/coronal.outlines") >= 1);

  window.click("notification/close.0");
  takePinchTool(window);
  C3DE_WAIT(window, "the scan knows its displacement", displacement_mm(s, "coronal") < 0.5);
  window.screenshot("created");
  window.moveTo(window.inView(0.38, 0.4));
  (void)pinch(window);
  for (int i = 1; i <= 8; ++i) window.moveTo(window.inView(0.38 + 0.03 * i, 0.4 + 0.04 * i));
  const Json pulled = C3DE_WAIT(window, "the tissue at the cross-hair has moved", displacement_mm(s, "coronal") > 2.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  for (const char *pane : {"axial", "coronal", "3D"}) {
    INFO(pane);
    CHECK(window.differsFrom("created", "pulled", 300, pane));
  }
  CHECK(numberOf(pulled, kPanel + "Pinch force") > 0.0);
  // Behind the liver, which has moved forwards: the scan does not show it twice.
  window.moveTo(pixelOf(window, "axial", centre, {-85.0, -116.0, liver[2]}));
  C3DE_WAIT(window, "its place is empty",
            textOf(s, "image/axial.readout").find("vacated by a body") != std::string::npos);
  window.release();
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  window.key("ctrl+r");
  C3DE_WAIT(window, "the scan is as it was read",
            s["transport"]["time_s"] == 0.0 && displacement_mm(s, "coronal") == 0.0);
}

TEST_CASE("an organ of a CT that is pulled by three centimetres and let go comes back, and nothing smears",
          "[image_returns]") {
  C3DE_WINDOW_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  WorkstationDriver window("image_returns");
  window.start({image.string(), labels.string()});
  const Json first = C3DE_WAIT(window, "the scan and its labels are shown",
                               s["panes"].size() == 4 && s["jobs"].empty() && !textOf(s, "image/Label map").empty());
  const Vec3 centre = vectorOf(first, "image/cross_hair");
  window.moveTo(pixelOf(window, "coronal", centre, centre));
  window.key("4");

  // The spleen, as in the labels; its supports are the proposed ones.
  window.click("segmentation/label_filter");
  window.type("spleen");
  window.click("segmentation/label.1");
  C3DE_WAIT(window, "it is picked", textOf(s, "segmentation/Picked").starts_with("261"));
  nameOrgan(window, "spleen");
  CHECK(window.value("segmentation/held") == "by its surroundings");
  CHECK(window.number("segmentation/surroundings") == 30000.0);
  (void)window.locate("segmentation/surroundings");
  window.screenshot("held");
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created",
            s["jobs"].empty() && s["transport"]["mode"] == "playing" && s["transport"]["time_s"] > 0.2 &&
                numberOf(s, "image/axial.outlines") + numberOf(s, "image/coronal.outlines") +
                        numberOf(s, "image/sagittal.outlines") >=
                    0);

  (void)pointAt(window, centre, {95.0, -135.0, 375.0});
  takePinchTool(window);
  C3DE_WAIT(window, "it rests where the scan shows it", displacement_mm(s, "axial") < 0.05);
  window.moveTo(window.inView(0.5, 0.5));
  window.waitFrames(5);
  window.screenshot("before");

  const Json held = pinch(window);
  const Vec3 from = vectorOf(held, kPanel + "Held point");
  double u = 0.5, v = 0.5;
  while (norm(vectorOf(window.state(), kPanel + "Hand") - from) < 30.0 && u > 0.05) {
    u -= 0.02;
    v += 0.01;
    window.moveTo(window.inView(u, v));
    window.waitFrames(2);
  }
  CHECK(norm(vectorOf(window.state(), kPanel + "Hand") - from) >= 30.0);
  C3DE_WAIT(window, "the organ gives way", norm(vectorOf(s, kPanel + "Held point") - from) > 5.0);
  window.waitFrames(20);
  window.screenshot("pulled");
  window.release();
  window.moveTo(window.inView(0.5, 0.5));
  C3DE_WAIT(window, "it has come back", displacement_mm(s, "axial") < 0.05);
  window.waitFrames(10);
  window.screenshot("returned");
  CHECK(window.differingPixels("before", "pulled", "3D") > 300);
  for (const char *pane : {"axial", "coronal", "sagittal", "3D"}) {
    INFO(pane);
    // Digits of the read-out, 78 to 98 pixels seen; pulled tissue changes thousands.
    CHECK(window.differingPixels("before", "returned", pane) < 250);
  }
}
