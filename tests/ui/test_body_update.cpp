// SPDX-License-Identifier: Apache-2.0
// The mask of a body is corrected while the body is simulated.
#include <algorithm>
#include <filesystem>
#include <vector>

#include "c3de/imaging/writing.h"
#include "support/catch.h"
#include "support/environment.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

constexpr Vec3 kRadii{40, 32, 28};  // mm

/// An ellipsoid of value 100 in 70 x 60 x 50 voxels of 2 mm around the origin.
fs::path phantomFile() {
  imaging::Volume volume;
  constexpr std::array<std::size_t, 3> n{70, 60, 50};
  volume.geometry = {n, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -69, -59, -49, 1}};
  std::vector<std::int16_t> voxels;
  for (std::size_t k = 0; k < n[2]; ++k)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t i = 0; i < n[0]; ++i) {
        const Vec3 x = volume.geometry.worldAt({double(i), double(j), double(k)});
        voxels.push_back(norm({x[0] / kRadii[0], x[1] / kRadii[1], x[2] / kRadii[2]}) < 1.0 ? 100 : 0);
      }
  volume.voxels = voxels;
  const fs::path file = outputFile("body_update_phantom.nii.gz");
  if (const auto written = imaging::writeVolume(file, volume); !written) FAIL(written.error().message);
  return file;
}

double numberIn(const Json &state, const std::string &name) { return std::strtod(row(state, name).c_str(), nullptr); }

/// A body "liver" of the ellipsoid, at rest under gravity along y.
/// @param points  its target count; empty: automatic
void createLiver(WorkstationDriver &window, const std::string &points = {}) {
  window.start({phantomFile().string()});
  C3DE_WAIT(window, "the image is shown", s["panes"].size() == 4 && s["jobs"].empty());
  window.enterNumber("segmentation/low", "60");
  C3DE_WAIT(window, "the organ is picked", textOf(s, "segmentation/Picked").ends_with(" voxels"));
  window.click("segmentation/name");
  window.key("ctrl+a");
  window.type("liver");
  window.key("Return");
  window.waitForValue("segmentation/material", "liver");
  if (!points.empty()) {
    window.click("segmentation/count_automatic");
    window.enterNumber("segmentation/points", points);
  }
  window.click("segmentation/create");
  C3DE_WAIT(window, "the body is created", s["jobs"].empty() && mode(s) == "playing" && s["transport"]["time_s"] > 0.0);
  window.enterNumber(kPanel + "world.gravity", "9.81");
  C3DE_WAIT(window, "it is displaced", numberIn(s, "Elastic energy") > 0.0 && s["transport"]["time_s"] > 1.0);
}

}  // namespace

TEST_CASE("strokes change a body that is simulated; it keeps its deformation, and each is undone exactly",
          "[body_update]") {
  C3DE_WINDOW_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("body_update").string());
  const fs::path session = freshFile("body_update.c3de");
  std::string updatedRows;
  {
    WorkstationDriver window("body_update");
    createLiver(window);
    CHECK_FALSE(window.has("segmentation/update"));
    window.choose("segmentation/edit_body", "liver");
    C3DE_WAIT(
        window, "the mask of the body is picked",
        textOf(s, "segmentation/Picked").ends_with(" voxels") && textOf(s, "segmentation/update_live") == "false");
    window.click("segmentation/update_live");
    window.moveTo(window.inSlice("axial", 0, 0));
    window.key("k");
    C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
    window.enterNumber("segmentation/brush_radius", "12");
    window.screenshot("before");

    // Tissue is added on one side while it plays.
    const Json before = window.state();
    window.drag(window.inSlice("axial", 34, 0), window.inSlice("axial", 50, 0), 6);
    waitForMessage(window, "Body updated: liver");
    const Json updated = window.state();
    const std::string text = notification(updated, "Body updated: liver")["text"].get<std::string>();
    CHECK_THAT(text, Contains("Elastic and kinetic energy: "));
    CHECK(updated["transport"]["time_s"].get<double>() >= before["transport"]["time_s"].get<double>());
    CHECK(updated["notifications"].dump().find("Could not") == std::string::npos);
    const Json playing = C3DE_WAIT(window, "it plays on", mode(s) == "playing" && s["jobs"].empty());
    CHECK(numberIn(playing, "Elastic energy") == Approx(numberIn(before, "Elastic energy")).epsilon(0.3));
    window.screenshot("added");

    // Undo restores the simulation before the stroke, bit for bit; redo the one after it.
    window.key("space");
    const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
    window.drag(window.inSlice("coronal", -34, 0), window.inSlice("coronal", -50, 0), 6);
    const Json second = C3DE_WAIT(window, "a second stroke is applied",
                                  s["jobs"].empty() && mode(s) == "paused" && !row(s, "Volume").empty() &&
                                      row(s, "Volume") != row(paused, "Volume") &&
                                      textOf(s, "segmentation/Picked") != textOf(paused, "segmentation/Picked") &&
                                      s["transport"]["steps"] == paused["transport"]["steps"]);
    window.moveTo(window.inView(0.5, 0.9));
    window.key("ctrl+z");
    const Json undone = C3DE_WAIT(window, "it is undone, and so is the stroke",
                                  s["jobs"].empty() && row(s, "Volume") == row(paused, "Volume") &&
                                      textOf(s, "segmentation/Picked") == textOf(paused, "segmentation/Picked"));
    for (const char *name : {"Kinetic energy", "Elastic energy", "Phyxels"})
      CHECK(row(undone, name) == row(paused, name));
    window.waitFrames(5);
    CHECK(row(window.state(), "Volume") == row(paused, "Volume"));
    window.key("ctrl+y");
    C3DE_WAIT(window, "it is redone",
              s["jobs"].empty() && row(s, "Volume") == row(second, "Volume") &&
                  textOf(s, "segmentation/Picked") == textOf(second, "segmentation/Picked"));

    // Two changes, then the button: undo reverts both.
    window.click("segmentation/update_live");
    window.drag(window.inSlice("coronal", -34, 20), window.inSlice("coronal", -50, 20), 4);
    const Json third =
        C3DE_WAIT(window, "a stroke is painted",
                  s["jobs"].empty() && textOf(s, "segmentation/Steps").ends_with("painted, painted, painted"));
    window.drag(window.inSlice("coronal", -34, -20), window.inSlice("coronal", -50, -20), 4);
    C3DE_WAIT(window, "another stroke is painted",
              s["jobs"].empty() && textOf(s, "segmentation/Picked") != textOf(third, "segmentation/Picked"));
    CHECK(row(window.state(), "Volume") == row(second, "Volume"));
    window.click("segmentation/update");
    C3DE_WAIT(window, "both are applied",
              s["jobs"].empty() && !row(s, "Volume").empty() && row(s, "Volume") != row(second, "Volume") &&
                  s["transport"]["steps"] == paused["transport"]["steps"]);
    window.moveTo(window.inView(0.5, 0.9));
    window.key("ctrl+z");
    C3DE_WAIT(window, "both are undone",
              s["jobs"].empty() && row(s, "Volume") == row(second, "Volume") &&
                  textOf(s, "segmentation/Picked") == textOf(second, "segmentation/Picked"));

    window.key("ctrl+s");
    window.enterFile(session);
    waitForMessage(window, "Session saved");
    updatedRows = row(window.state(), "Volume") + ", " + row(window.state(), "Elastic energy");
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  WorkstationDriver window("body_update_opened");
  window.start({session.string()});
  C3DE_WAIT(window, "the session is opened",
            s["jobs"].empty() && row(s, "Volume") + ", " + row(s, "Elastic energy") == updatedRows);
}

// Not a test of ctest: prints the times of nine strokes with 3 000 points.
TEST_CASE("times from a stroke to the updated body", "[.body_update_times]") {
  C3DE_WINDOW_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("body_update_times").string());
  WorkstationDriver window("body_update_times");
  createLiver(window, "3000");
  window.choose("segmentation/edit_body", "liver");
  C3DE_WAIT(window, "the mask of the body is picked", textOf(s, "segmentation/update_live") == "false");
  window.click("segmentation/update_live");
  window.moveTo(window.inSlice("axial", 0, 0));
  window.key("k");
  C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
  std::vector<double> times_ms;
  std::string last;
  for (int i = 0; i < 9; ++i) {
    const double y = -20.0 + 5.0 * i;
    window.drag(window.inSlice("axial", 30, y), window.inSlice("axial", 46, y), 4);
    const Json s = window.waitUntil("the body is updated", [&](const Json &state) {
      const Json message = notification(state, "Body updated: liver");
      return state["jobs"].empty() && message.is_object() && message["text"] != last;
    });
    last = notification(s, "Body updated: liver")["text"].get<std::string>();
    times_ms.push_back(std::strtod(last.c_str(), nullptr));
  }
  std::sort(times_ms.begin(), times_ms.end());
  WARN("median " << times_ms[4] << " ms, " << times_ms.front() << " … " << times_ms.back() << " ms, "
                 << row(window.state(), "Phyxels") << " phyxels");
}

TEST_CASE("a stroke that is being drawn while a body is updated is kept", "[body_update_drawing]") {
  C3DE_WINDOW_OR_SKIP();
  const ScopedEnvironment user("C3DE_HOME", freshHome("body_update_drawing").string());
  WorkstationDriver window("body_update_drawing");
  createLiver(window);
  window.choose("segmentation/edit_body", "liver");
  C3DE_WAIT(window, "the mask of the body is picked", textOf(s, "segmentation/update_live") == "false");
  window.click("segmentation/update_live");
  window.moveTo(window.inSlice("axial", 0, 0));
  window.key("k");
  C3DE_WAIT(window, "the brush is active", s["tool"] == "segmentation.brush");
  window.drag(window.inSlice("axial", 34, 0), window.inSlice("axial", 50, 0), 4);
  window.moveTo(window.inSlice("axial", -34, 0));
  window.press();
  window.moveTo(window.inSlice("axial", -50, 0));
  waitForMessage(window, "Body updated: liver");
  C3DE_WAIT(window, "the first stroke is applied", s["jobs"].empty());
  CHECK(window.state()["tool"] == "segmentation.brush");
  window.release();
  C3DE_WAIT(window, "the second stroke is painted",
            s["jobs"].empty() && textOf(s, "segmentation/Steps").ends_with("painted, painted"));
  window.key("ctrl+q");
}
