// SPDX-License-Identifier: Apache-2.0
// Supports and loads on a block: one click fixes a side, another presses the opposite one, as a scene does. Boxes,
// dragged arrows, and nodes of the scene list.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "ui/scan_window.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

constexpr double kPascals = 20.0 * 133.322;        // 20 mmHg
constexpr double kMiddle[3] = {0.05, 0.06, 0.05};  // m, of the upper side at rest

/// A block of 100 x 60 x 100 mm with a landmark in the middle of its upper side (y = 60 mm).
/// @param more  supports and loads
fs::path blockScene(const std::string &name, const std::string &more) {
  std::ofstream(outputFile(name + ".obj"))
      << "v 0 0 0\nv 0.1 0 0\nv 0.1 0.06 0\nv 0 0.06 0\nv 0 0 0.1\nv 0.1 0 0.1\nv 0.1 0.06 0.1\nv 0 0.06 0.1\n"
         "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n";
  fs::path scene = outputFile(name + ".toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Block\"\n[world]\ngravity = [0, 0, 0]\n[solver]\nintegrator = "
                          "\"quasistatic\"\n[[body]]\nname = \"block\"\nmesh = \""
                       << name
                       << ".obj\"\nmesh_unit = \"m\"\nmaterial = { law = \"neo_hookean\", youngs_modulus = 2e4, "
                          "poisson_ratio = 0.3, density = 1000.0 }\nsampling = { spacing = 0.01 }\n"
                          "[[landmark]]\nname = \"middle\"\nat = ["
                       << kMiddle[0] << ", " << kMiddle[1] << ", " << kMiddle[2] << "]\n"
                       << more;
  return scene;
}

/// mm, of the landmark by a run of the scene without a window.
double depthOfScene() {
  WorkstationDriver run("block_loads_scene");
  const fs::path scene = blockScene("block_loads_scene",
                                    "[[fix]]\nregion = { box = { min = [-1, -0.001, -1], max = [1, 0, 1] } }\n"
                                    "[[load]]\nregion = { box = { min = [-1, 0.06, -1], max = [1, 0.061, 1] } }\n"
                                    "pressure = " +
                                        std::to_string(kPascals) + "\n");
  const fs::path report = freshFile("block_loads_scene.json");
  REQUIRE(run.startAndWait({"run", scene.string(), "--report", report.string()}) == 0);
  const Json json = Json::parse(std::ifstream(report));
  return -json["landmarks"][0]["displacement_mm"][1].get<double>();
}

void clickSide(WorkstationDriver &window, const std::string &viewKey, const std::string &area) {
  window.moveTo(window.inView(0.9, 0.9));
  window.key(viewKey);
  window.key("f");
  const Json view = window.state()["camera"];
  C3DE_WAIT(window, "the view is at rest", s["camera"] == view);
  window.clickAt(window.inView(0.4, 0.6));
  C3DE_WAIT(window, "the side is selected", row(s, "Selected").find(area) != std::string::npos);
}

/// Fraction of the view at which a point of the plane through the middle of the view is seen, along -z.
Point seenAt(const WorkstationDriver &window, double x_mm, double y_mm) {
  const Json camera = window.state()["camera"];
  constexpr double kFieldOfView = 0.6;  // rad, vertical
  const double height_mm = 2.0 * camera["distance"].get<double>() * std::tan(0.5 * kFieldOfView);
  const Point low = window.inView(0.0, 0.0), high = window.inView(1.0, 1.0);
  const double mm = (high.y - low.y) / height_mm;
  const Point middle = window.inView(0.5, 0.5);
  return {middle.x + mm * (x_mm - camera["focus"][0].get<double>()),
          middle.y - mm * (y_mm - camera["focus"][1].get<double>())};
}

bool hasNode(const Json &state, const std::string &name, bool isVisible = true) {
  for (const Json &node : state["nodes"])
    if (node["name"] == name) return node["visible"] == isVisible;
  return false;
}

}  // namespace

TEST_CASE("a block is fixed by one click and pressed on the opposite side as by a scene", "[block_loads]") {
  C3DE_ORGAN_OR_SKIP();
  const double wanted = depthOfScene();
  CHECK(wanted > 3.0);
  WorkstationDriver window("block_loads");
  openOrgan(window, {blockScene("block_loads", "").string()});
  window.key("n");
  C3DE_WAIT(window, "the load tool is active", s["tool"] == "pointbased.load");
  window.choose(kPanel + "load_mode", "face");
  clickSide(window, "6", "10000.0 mm²");
  window.click(kPanel + "load_add");
  C3DE_WAIT(window, "the support is listed and is a node", !row(s, "Fix 1").empty() && hasNode(s, "Fix 1"));
  clickSide(window, "5", "10000.0 mm²");
  window.choose(kPanel + "load_kind", "Pressure");
  window.choose(kPanel + "load_unit", "mmHg");
  window.enterNumber(kPanel + "load_pressure", "20");
  window.click(kPanel + "load_add");
  C3DE_WAIT(window, "the pressure is a node", !row(s, "Pressure 2").empty() && hasNode(s, "Pressure 2"));
  // Below the body, not beside it.
  const Json listed = window.state();
  const auto depthOf = [&](const std::string &name) {
    for (const Json &node : listed["nodes"])
      if (node["name"] == name) return node["depth"].get<int>();
    return -1;
  };
  CHECK(depthOf("block") == 1);
  CHECK(depthOf("Pressure 2") == 2);

  // From the front, the tip of the arrow is dragged down: a larger pressure, in one step of undo.
  window.key("1");
  window.key("f");
  window.screenshotAtRest("arrow");
  // Of its longest arrow a body shows 0.28 of its diagonal.
  const double length_mm = 0.28 * 1e3 * std::sqrt(0.1 * 0.1 + 0.06 * 0.06 + 0.1 * 0.1);
  const Point tip = seenAt(window, 50.0, 60.0 - length_mm);
  window.moveTo(tip);
  window.press();
  window.moveAlong(tip, {tip.x, tip.y + 60.0}, 4);
  C3DE_WAIT(window, "its value is shown", row(s, "Dragged").starts_with("Pressure 2: 3."));
  window.screenshotAtRest("dragged");
  window.release();
  C3DE_WAIT(window, "it is set", numberOf(s, kPanel + "load_value_2") > 3.0);
  CHECK(window.value(kPanel + "load_chosen_2") == "true");
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is as before", std::abs(numberOf(s, kPanel + "load_value_2") - 2.666) < 1e-6);

  window.click("measurements/header");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  const Json pressed = C3DE_WAIT(window, "it is solved",
                                 s["transport"]["mode"] == "paused" && s["transport"]["steps"].get<int>() > 0 &&
                                     numberOf(s, "measurements/middle.now") > 0.0);
  const double depth = numberOf(pressed, "measurements/middle.now");
  INFO("by hand " << depth << " mm, by the scene " << wanted << " mm");
  // The scene holds phyxels of the side themselves, the support by hand the means of its patches, which yield a little.
  CHECK(std::abs(depth - wanted) < 0.03 * wanted);
  window.key("ctrl+t");
  C3DE_WAIT(window, "the plots show the landmark of the solution, whose time is that of the reset",
            std::abs(numberOf(s, "plots/measure.middle") - depth) < 0.001 * depth);
  window.key("ctrl+t");
  C3DE_WAIT(window, "the strip is closed", s["values"]["plots/shown"] == "false");
  // A click on the deformed block does not change where its landmark is looked for.
  clickSide(window, "1", "6000.0 mm²");

  // Hidden by its node, removed by a key, and undone.
  window.click(kPanel + "load_chosen_2");
  window.waitForValue(kPanel + "load_chosen_2", "true");
  window.screenshotAtRest("shown");
  window.click("scene/Pressure 2");
  C3DE_WAIT(window, "it is hidden", hasNode(s, "Pressure 2", false) && s["values"][kPanel + "load_shown_2"] == "false");
  window.screenshot("hidden");
  CHECK(window.differsFrom("shown", "hidden", 50.0));
  window.moveTo(window.inView(0.9, 0.9));
  window.key("Delete");
  C3DE_WAIT(window, "the chosen one is removed", row(s, "Pressure 2").empty() && !hasNode(s, "Pressure 2", false));
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is back, still hidden", !row(s, "Pressure 2").empty() && hasNode(s, "Pressure 2", false));
  C3DE_WAIT(window, "the landmark is in the block", std::abs(numberOf(s, "measurements/middle.now") - depth) < 0.5);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("boxes select what is visible of a block, and Escape cancels them", "[block_boxes]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("block_boxes");
  openOrgan(window, {blockScene("block_boxes", "").string()});
  window.key("n");
  C3DE_WAIT(window, "the load tool is active", s["tool"] == "pointbased.load");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("1");
  window.key("f");
  window.keys({"q", "q"});
  window.waitForValue(kPanel + "load_mode", "box");
  const Point low = window.inView(0.1, 0.1), high = window.inView(0.9, 0.9);
  window.moveTo(low);
  window.press();
  window.moveAlong(low, high, 4);
  C3DE_WAIT(window, "the visible side is previewed", row(s, "Selected").find("6000.0 mm²") != std::string::npos);
  window.screenshotAtRest("preview");
  window.key("Escape");
  C3DE_WAIT(window, "nothing is selected", row(s, "Selected") == "nothing");
  window.release();
  window.key("x");
  window.waitForValue(kPanel + "load_through", "true");
  window.drag(low, high, 4);
  C3DE_WAIT(window, "all of it is selected", row(s, "Selected").find("44000.0 mm²") != std::string::npos);
  window.key("x");
  window.keyDown("alt");
  window.drag(low, high, 4);
  window.keyUp("alt");
  C3DE_WAIT(window, "the visible side is removed", row(s, "Selected").find("38000.0 mm²") != std::string::npos);
  window.drag(window.inView(0.02, 0.02), window.inView(0.05, 0.05), 2);
  C3DE_WAIT(window, "a box beside it states so", row(s, "Note") == "The box meets no visible surface");
  CHECK(row(window.state(), "Selected").find("38000.0 mm²") != std::string::npos);
  window.key("Delete");
  C3DE_WAIT(window, "it is cleared", row(s, "Selected") == "nothing");
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("a box in a slice selects the skin near its plane", "[slice_boxes]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("slice_boxes");
  (void)createBodyFromScan(window, "slice_boxes", "800");
  window.moveTo(window.inPane("axial", 0.5, 0.5));
  window.key("n");
  C3DE_WAIT(window, "the load tool is active", s["tool"] == "pointbased.load");
  window.choose(kPanel + "load_mode", "box");
  // The left half of the slice, without the table below the trunk.
  const Point low = window.inSlice("axial", -115.0, -75.0), high = window.inSlice("axial", 0.0, 75.0);
  window.moveTo(low);
  window.press();
  window.moveAlong(low, high, 4);
  C3DE_WAIT(window, "a part is previewed", row(s, "Selected").find("mm²") != std::string::npos);
  window.screenshot("preview");  // it plays
  window.release();
  C3DE_WAIT(window, "it is selected", row(s, "Selected").find("mm²") != std::string::npos);
  window.drag(window.inSlice("axial", 5.0, -5.0), window.inSlice("axial", 15.0, 5.0), 3);
  C3DE_WAIT(window, "inside there is no skin", row(s, "Note").starts_with("The box meets no surface within 2 mm"));
  const std::string thin = row(window.state(), "Selected");
  window.keys({"bracketright", "bracketright", "bracketright", "bracketright", "bracketright"});
  C3DE_WAIT(window, "the depth is larger", numberOf(s, kPanel + "load_depth") > 3.5);
  window.drag(low, high, 4);
  C3DE_WAIT(window, "more is selected", row(s, "Selected") != thin);
  CHECK(notification(window.state(), "The support or load was not set").is_null());
}
