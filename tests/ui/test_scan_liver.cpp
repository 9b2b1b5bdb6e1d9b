// SPDX-License-Identifier: Apache-2.0
// The liver of a CT is pulled by three centimetres.
// The two cases [.long] take five minutes each: a body of 3000 phyxels comes back far slower than in real time.
#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "c3de/core/vec.h"
#include "c3de/render/camera.h"
#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// Position of a world point in the 3D view of a patient.
Point inSpace(const WorkstationDriver &window, const Vec3 &world) {
  const Json state = window.state(), r = state["panes"]["3D"], c = state["camera"];
  render::Camera camera;
  camera.upAxis = render::UpAxis::z;
  camera.yaw = c["yaw"];
  camera.pitch = c["pitch"];
  camera.distance = c["distance"];
  for (std::size_t i = 0; i < 3; ++i) camera.focus[i] = c["focus"][i];
  const Vec3 pixel = camera.project(world, r["w"], r["h"]);
  return {r["x"].get<double>() + pixel[0], r["y"].get<double>() + pixel[1]};
}

bool isLiverHeld(const Json &s) { return textOf(s, kPanel + "Held inside") == "scan: liver"; }

/// A simulated CT, with the cross-hair in its liver and the pinch tool active.
class LiverOfCt {
 public:
  LiverOfCt(const char *scenario, const ScanFiles &files) : window(scenario), scenario_(scenario) {
    openDialog(window, files);
    CHECK(window.value("scan/use.liver") == "liver");
    CHECK(window.value("scan/use.vertebrae_L1") == "rigid");
    CHECK(window.value("scan/background.material") == "fat");
    CHECK(window.value("scan/points") == "3000");
    (void)createBody(window);
    window.click("notification/close.0");
    window.click("notification/close.0");
    window.click("tissues/header");
    C3DE_WAIT(window, "labels are followed", std::isfinite(numberOf(s, "tissues/liver.det_f")));
    window.clickAt(window.inSlice("coronal", kPlace[0] - kMiddle[0], kMiddle[2] - kPlace[2]));
    C3DE_WAIT(window, "the axial slice is there",
              std::abs(numberAfter(textOf(s, "image/cross_hair"), " ", 2) - kPlace[2]) < 2);
    takePinch(window);
    window.moveTo(window.inSlice("axial", 0, 0));
    window.key("4");  // window and level of the abdomen
  }

  /// By three centimetres to the front in the axial slice; the button stays pressed. @return start of the drag, mm
  Vec3 pullInSlice() {
    const double x = kPlace[0] - kMiddle[0], y = kPlace[1] - kMiddle[1];
    pull(window, window.inSlice("axial", x, y), window.inSlice("axial", x, y - 30.0));
    const Json held = window.waitUntil("it is held", isLiverHeld);
    return {kPlace[0], kPlace[1], vectorOf(held, kPanel + "Hand")[2]};
  }

  /// The conditions after the tissue has followed a drag that began there, and after its release.
  void follow(const std::string &where, const std::string &pane, const Vec3 &from) {
    const double begin = window.state()["transport"]["time_s"];
    C3DE_WAIT(window, "the tissue has come after the hand",
              s["transport"]["time_s"].get<double>() > begin + 2.5 && numberOf(s, "tissues/liver.largest") > 10.0);
    window.screenshot(where + "_pulled");
    const Json pulled = window.state();
    CHECK(std::abs(norm(vectorOf(pulled, kPanel + "Hand") - from) - 30.0) < 1.5);
    CHECK(norm(vectorOf(pulled, kPanel + "Held point") - from) > 12.0);
    CHECK(numberOf(pulled, kPanel + "Pinch force") > 5.0);
    // Arrow, point and force in N are in this slice, and in the 3D view.
    CHECK_THAT(textOf(pulled, "image/" + pane + ".marks"), Contains("7 in the plane"));
    CHECK(window.differsFrom(where + "_before", where + "_pulled", 100, "3D"));
    window.key("space");
    C3DE_WAIT(window, "it stands", s["transport"]["mode"] == "paused");
    window.release();
    const auto motions = exportTissues(window, scenario_ + "_" + where);
    REQUIRE(motions.size() > 50);
    for (const auto &[label, motion] : motions) {
      INFO(label);
      CHECK(motion.leastRatio > 0.0);
      if (label.starts_with("vertebrae")) CHECK(motion.largest_mm < 0.01);
    }
    CHECK(motions.at("kidney_right").mean_mm > 2.0);
    CHECK(motions.at("kidney_right").largest_mm > 8.0);
    CHECK(motions.at("kidney_left").largest_mm < 2.0);
    window.moveTo(window.inView(0.95, 0.9));
    window.key("space");
    // The table shows tenths of a millimetre.
    window.waitUntil("all has come back", [](const Json &s) {
      std::size_t back = 0;
      for (const auto &[key, text] : s["values"].items())
        if (key.starts_with("tissues/") && key.ends_with(".largest") && numberOf(s, key) < 0.15) ++back;
      return textOf(s, "tissues/count").starts_with(std::to_string(back) + " of ");
    });
  }

  WorkstationDriver window;

 private:
  // mm: of the image, which is in the middle of the views; and in the liver, next to the right kidney.
  static constexpr Vec3 kMiddle{-3.5, -161.3, 260.8}, kPlace{-85, -185, 368};
  std::string scenario_;
};

}  // namespace

TEST_CASE("The liver of a CT is pulled by three centimetres in a slice and in the 3D view, and all comes back",
          "[.long][.scan_liver]") {
  C3DE_ORGAN_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  LiverOfCt liver("scan_liver", {image, labels});
  WorkstationDriver &window = liver.window;
  window.screenshot("slice_before");
  liver.follow("slice", "axial", liver.pullInSlice());

  // In the 3D view, from the front: with the part before the coronal slice hidden, the liver is on the face of the cut.
  const Vec3 onFace{-95, -161.3, 372};
  window.key("shift+c");
  window.waitForValue("image/cut_coronal", "without the front");
  window.key("1");
  window.key("f");
  window.waitFrames(10);
  window.screenshot("space_before");
  pull(window, inSpace(window, onFace), inSpace(window, onFace + Vec3{30, 0, 0}));
  window.waitUntil("it is held", isLiverHeld);
  liver.follow("space", "coronal", onFace);
}

TEST_CASE("The first pull at a CT does not pause the simulation while other programs keep the machine busy",
          "[scan_liver_busy]") {
  C3DE_ORGAN_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  LiverOfCt liver("scan_liver_busy", {image, labels});
  WorkstationDriver &window = liver.window;
  // The views are drawn by software at the same time.
  std::vector<std::jthread> busy;
  for (unsigned k = 0; k < std::max(2u, std::thread::hardware_concurrency()); ++k)
    busy.emplace_back([](const std::stop_token &stop) {
      while (!stop.stop_requested()) {
      }
    });
  std::string paused;
  const auto look = [&paused](const Json &s) {
    if (s["transport"]["mode"] != "playing") paused = s["notifications"].dump();
    return paused.empty();
  };
  (void)liver.pullInSlice();
  C3DE_WAIT(window, "the tissue comes after the hand", !look(s) || numberOf(s, "tissues/liver.largest") > 10.0);
  window.screenshot("pulled");
  WARN("beside busy programs: " << window.value("status/rate"));
  window.release();
  const int steps = window.state()["transport"]["steps"];
  C3DE_WAIT(window, "it plays on after the release", !look(s) || s["transport"]["steps"].get<int>() > steps + 20);
  CHECK(paused == "");
}

TEST_CASE("Where the liver of a CT has been pulled its cells get finer, and it is pulled again",
          "[.long][.scan_liver_finer]") {
  C3DE_ORGAN_OR_SKIP();
  C3DE_DATA_OR_SKIP(image, "volume/totalseg/example_ct.nii.gz");
  C3DE_DATA_OR_SKIP(labels, "volume/totalseg/example_seg_fast_force_split.nii.gz");
  LiverOfCt liver("scan_liver_finer", {image, labels});
  WorkstationDriver &window = liver.window;
  (void)liver.pullInSlice();
  C3DE_WAIT(window, "the tissue has come after the hand", numberOf(s, "tissues/liver.largest") > 10.0);
  window.release();

  // As many phyxels; stiff vessels there get a little added mass for it.
  window.click(kPanel + "finer");
  const Json finer =
      C3DE_WAIT(window, "the body is sampled anew", s["jobs"].empty() && s["values"].contains(kPanel + "Halved cells"));
  CHECK(numberOf(finer, kPanel + "Halved cells") > 50);
  CHECK_THAT(textOf(finer, kPanel + "Added inertia"), Contains(" % of what can move, to "));
  CHECK_THAT(textOf(finer, kPanel + "Computed"), Contains("explicit"));
  window.moveTo(window.inView(0.95, 0.9));
  if (window.state()["transport"]["mode"] != "playing") window.key("space");
  window.screenshot("finer_before");
  liver.follow("finer", "axial", liver.pullInSlice());
}
