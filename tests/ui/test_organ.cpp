// SPDX-License-Identifier: Apache-2.0
// User actions with an organ in the window: open it, play, pull, pause, step, reset, look inside.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "support/catch.h"
#include "ui/workstation_driver.h"

using c3de::test::Json;
using c3de::test::Point;
using c3de::test::WorkstationDriver;

namespace {

namespace fs = std::filesystem;
constexpr const char *kPanel = "pointbased.controller/";

fs::path organMesh() { return fs::path(testResourcesFolder()) / "meshes" / "organ.obj"; }

/// A floating organ: only the user moves it.
fs::path floatingOrgan() {
  const fs::path scene = c3de::test::outputFile("floating.toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Floating organ\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n"
         "[solver]\ndamping = 5.0\n[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 6e3, poisson_ratio = 0.4, density = 1000.0 }\n"
      << "sampling = { count = 400 }\n";
  return scene;
}

void startOrgan(WorkstationDriver &window) {
  window.start({floatingOrgan().string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"].get<bool>() && s["jobs"].empty());
  // Its node and its rows appear with the first snapshot and push the rows below them down.
  C3DE_WAIT(window, "the organ is shown",
            s["nodes"].size() >= 2 && !s["values"].value(std::string(kPanel) + "Surfels", "").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
}

std::array<double, 3> millimetres(const std::string &text) {
  std::array<double, 3> at{};
  std::istringstream in(text);
  in >> at[0] >> at[1] >> at[2];
  return at;
}

double distance(const std::array<double, 3> &a, const std::array<double, 3> &b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

std::string row(const Json &state, const char *name) { return state["values"].value(std::string(kPanel) + name, ""); }

std::string mode(const Json &state) { return state["transport"]["mode"]; }

}  // namespace

TEST_CASE("a mesh alone falls on a floor and stays in sight", "[organ_floor]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_floor");
  window.start({organMesh().string(), "--play"});
  C3DE_WAIT(window, "the organ is shown", !row(s, "Surfels").empty());
  window.screenshot("falling");
  // Free fall would have taken it 20 m down.
  C3DE_WAIT(window, "two seconds are simulated", s["transport"]["time_s"].get<double>() > 2.0);
  window.key("space");
  C3DE_WAIT(window, "it stands still", mode(s) == "paused");
  window.screenshot("lying");
  CHECK(window.shareOfColour("lying", "r > 1.6*g && r > 0.25") > 0.03);
  const Json nodes = window.state()["nodes"];
  CHECK(std::any_of(nodes.begin(), nodes.end(),
                    [](const Json &node) { return node.dump().find("World box") != std::string::npos; }));
}

TEST_CASE("three lines say how accurate an organ is, estimated and then verified, until it moves on",
          "[organ_verify]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_verify");
  const fs::path scene = c3de::test::outputFile("verified.toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Hanging organ\"\n[world]\ngravity = [0.0, 0.0, "
                          "-9.81]\n[solver]\ndamping = 20.0\n[view]\n"
                          "colour = \"verified\"\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string()
                       << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
                          "sampling = { count = 400 }\n[[fix]]\nregion = { half_space = { point = [-0.06, 0, 0], "
                          "normal = [1, 0, 0] } }\n";
  window.start({scene.string(), "--play"});
  C3DE_WAIT(window, "a part of a second is simulated",
            !row(s, "Surfels").empty() && s["transport"]["time_s"].get<double>() > 0.3);
  window.key("space");
  C3DE_WAIT(window, "it is paused", mode(s) == "paused");
  const std::string hash = row(window.state(), "State hash");
  CHECK(row(window.state(), "Colours").empty());
  const auto isOnBasis = [](const char *basis) {
    return [basis](const Json &s) {
      const std::string line = row(s, "Displacement");
      return line.starts_with("± ") && line.find(basis) != std::string::npos;
    };
  };
  const Json estimated = window.waitUntil("the error is estimated", isOnBasis("estimated by two coarser solutions"));
  CHECK_THAT(row(estimated, "Stress and strain"), Contains("± ") && Contains("outside singular regions"));
  CHECK_THAT(row(estimated, "Singular regions"), Contains("edge of support"));
  window.locate(std::string(kPanel) + "finer");
  window.screenshotAtRest("estimated");
  window.click(std::string(kPanel) + "verify");
  const Json verified = window.waitUntil("the error is measured", isOnBasis("verified with"));
  // One statement: no other row of the panel is an error.
  for (const char *old : {"Error estimate", "Error expected", "Estimated now", "At most", "Shadow"})
    CHECK(row(verified, old).empty());
  CHECK(row(verified, "State hash") == hash);
  C3DE_WAIT(window, "the colours are those of the verification", row(s, "Colours").starts_with("Error, verified, 0"));
  window.screenshot("verified");
  window.click(std::string(kPanel) + "step");
  C3DE_WAIT(window, "the state has moved on", row(s, "Colours").empty());
  window.screenshot("moved_on");
  window.key("ctrl+shift+v");
  C3DE_WAIT(window, "the keys have verified it, too", row(s, "Colours").starts_with("Error, verified, 0"));
}

TEST_CASE("a pinched organ follows the hand and lets go on release", "[organ_pinch]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_pinch");
  startOrgan(window);
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  CHECK(row(window.state(), "Pinch force") == "–");

  const Json camera = window.state()["camera"];
  const Point from = window.inView(0.5, 0.5), to = window.inView(0.62, 0.38);
  window.moveTo(from);
  window.press();
  const Json held = C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty());
  const auto start = millimetres(row(held, "Held point"));
  window.moveAlong(from, to, 8);
  C3DE_WAIT(window, "the hand pulls", std::strtod(row(s, "Pinch force").c_str(), nullptr) > 0.0);
  window.screenshot("pulling");
  const auto hand = millimetres(row(window.state(), "Hand"));
  REQUIRE(distance(hand, start) > 10.0);
  window.waitUntil("the organ follows", [&](const Json &s) {
    const auto at = millimetres(row(s, "Held point"));
    return distance(at, start) > 0.3 * distance(hand, start) && distance(at, hand) < distance(start, hand);
  });
  window.screenshot("followed");
  window.release();
  C3DE_WAIT(window, "it is let go", row(s, "Pinch force") == "–");
  CHECK(window.state()["camera"] == camera);
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("a pinch while the simulation is stopped says so, and pulls as soon as it plays", "[organ_pinch_stopped]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_pinch_stopped");
  startOrgan(window);
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
  const Point from = window.inView(0.5, 0.5), to = window.inView(0.62, 0.38);
  window.moveTo(from);
  C3DE_WAIT(window, "the status bar says it",
            s["values"].value("status/hint", "").starts_with("Space plays the simulation"));
  window.press();
  const Json held =
      C3DE_WAIT(window, "it is said at the hand", row(s, "Nothing moves") == "Stopped: press Space to play");
  CHECK(mode(held) == "stopped");
  const auto start = millimetres(row(held, "Held point"));
  window.moveAlong(from, to, 4);
  window.waitFrames(5);
  window.screenshot("stopped");
  CHECK(window.state()["transport"]["steps"] == 0);

  // The hold is retained, and acts.
  window.key("space");
  C3DE_WAIT(window, "the organ follows",
            mode(s) == "playing" && row(s, "Nothing moves").empty() &&
                distance(millimetres(row(s, "Held point")), start) > 5.0);
  window.key("space");
  C3DE_WAIT(window, "a pause is said as well", row(s, "Nothing moves") == "Paused: press Space to play");
  window.screenshot("paused");
  window.release();
  C3DE_WAIT(window, "it is released", row(s, "Held point").empty());
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("play, pause, step and reset do what they say, and reset is exact", "[organ_transport]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_transport");
  startOrgan(window);
  const std::string initial = C3DE_WAIT(window, "the initial state is shown",
                                        !row(s, "State hash").empty())["values"][std::string(kPanel) + "State hash"];
  // It needs a cause of motion: pull once.
  window.key("p");
  window.click("toolbar/play");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  window.drag(window.inView(0.5, 0.5), window.inView(0.6, 0.4), 6);
  window.click("toolbar/play");
  const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const auto steps = paused["transport"]["steps"].get<long long>();
  CHECK(paused["transport"]["time_s"] > 0.0);
  C3DE_WAIT(window, "the pulled state is shown",
            row(s, "State hash") != initial && row(s, "Steps") == std::to_string(steps));

  window.moveTo(window.inView(0.9, 0.9));
  window.key("Right");
  C3DE_WAIT(window, "one step is made", s["transport"]["steps"].get<long long>() == steps + 1);
  CHECK(mode(window.state()) == "paused");
  window.screenshot("paused");
  window.key("ctrl+r");
  const Json reset = C3DE_WAIT(window, "it is reset", s["transport"]["steps"] == 0);
  CHECK(reset["transport"]["time_s"] == 0.0);
  C3DE_WAIT(window, "the initial state is back, bit for bit", row(s, "State hash") == initial);

  // The target rate is the selected one.
  window.click("toolbar/rate");
  window.click("toolbar/rate.option.1/4×");
  C3DE_WAIT(window, "the rate is set", s["transport"]["target_rate"] == 0.25);
  // Stop returns to the start, too.
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 2);
  window.click("toolbar/stop");
  C3DE_WAIT(window, "it has stopped", mode(s) == "stopped" && s["transport"]["steps"] == 0);
}

TEST_CASE("an organ is loaded through the plugin's panel, and a bad file leaves it", "[organ_load]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_load");
  startOrgan(window);
  const fs::path copy = c3de::test::outputFile("second_organ.obj");
  fs::copy_file(organMesh(), copy, fs::copy_options::overwrite_existing);
  const auto choose = [&](const fs::path &file) {
    window.click("pointbased.controller/browse");
    window.enterFile(file);
    C3DE_WAIT(window, "the file is taken", row(s, "browse") == fs::weakly_canonical(file).string());
    window.click("pointbased.controller/load");
  };
  choose(copy);
  C3DE_WAIT(window, "the new organ is there", row(s, "Body") == "second_organ" && s["jobs"].empty());
  CHECK(window.state()["notifications"].empty());
  window.screenshot("loaded");

  const fs::path bad = c3de::test::outputFile("bad_organ.obj");
  std::ofstream(bad) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n";
  choose(bad);
  const Json refused = C3DE_WAIT(window, "it is refused", !s["notifications"].empty());
  CHECK(refused["notifications"][0]["severity"] == "error");
  CHECK_THAT(refused["notifications"][0]["text"].get<std::string>(), Contains("bad_organ.obj"));
  CHECK(row(refused, "Body") == "second_organ");
  window.screenshot("refused");
}

TEST_CASE("a mesh that says its unit is opened in it", "[organ_unit]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = c3de::test::outputFile("in_metres.obj");
  std::ofstream(file)
      << "# SPACE=LPS UNITS=m\nv 0 0 0\nv .2 0 0\nv .2 .1 0\nv 0 .1 0\nv 0 0 .1\nv .2 0 .1\nv .2 .1 .1\n"
         "v 0 .1 .1\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const auto isTwoLitres = [](const Json &s) { return s["jobs"].empty() && row(s, "Volume") == "2000 mL"; };
  {
    WorkstationDriver window("organ_unit");
    window.start({file.string()});
    CHECK(window.waitUntil("it is of the file's unit", isTwoLitres)["notifications"].empty());
    // The dialog leaves the unit to the file, too.
    window.key("ctrl+m");
    C3DE_WAIT(window, "the dialog is open", s["widgets"].contains("dialog/path"));
    CHECK(window.value("dialog/unit").empty());
    window.screenshot("dialog");
  }
  WorkstationDriver asked("organ_unit_asked");
  asked.start({"--unit", "cm", file.string()});
  const Json state = C3DE_WAIT(asked, "a unit that is asked for wins, and looks wrong",
                               s["jobs"].empty() && !s["notifications"].empty());
  CHECK(state["notifications"][0]["title"] == "Is the unit right?");
  CHECK_THAT(state["notifications"][0]["text"].get<std::string>(), Contains("cm, as requested"));
  // The panel of the plugin leaves it to the file.
  CHECK(row(state, "Volume") != "2000 mL");
  asked.click("pointbased.controller/browse");
  asked.enterFile(file);
  C3DE_WAIT(asked, "the file is taken", row(s, "browse") == fs::weakly_canonical(file).string());
  asked.click("pointbased.controller/load");
  asked.waitUntil("it is of the file's unit", isTwoLitres);
}

TEST_CASE("a file that cannot be opened leaves the simulation that is open", "[organ_keeps]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_keeps");
  startOrgan(window);
  const fs::path bad = c3de::test::outputFile("bad_scene.toml");
  std::ofstream(bad) << "format = 1\n[world]\ngravty = [0.0, -9.81, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \""
                     << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n";
  window.key("space");
  window.key("ctrl+o");
  window.enterFile(bad);
  const Json state = C3DE_WAIT(window, "it is refused", s["notifications"].size() == 1);
  const std::string text = state["notifications"][0]["text"];
  CHECK_THAT(text, Contains("bad_scene.toml:3") && Contains("gravty") && Contains("gravity"));
  CHECK(state["transport"]["title"] == "Floating organ");
  const auto steps = state["transport"]["steps"].get<long long>();
  C3DE_WAIT(window, "it goes on", s["transport"]["steps"].get<long long>() > steps + 5);
  window.screenshot("kept");
}

TEST_CASE("a simulation that plays is closed by the menu, and another one is opened", "[organ_close]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_close");
  startOrgan(window);
  window.key("p");
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  window.click("menu/file");
  window.click("menu/file.close_simulation");
  const Json closed = C3DE_WAIT(window, "it is closed", s["transport"]["exists"] == false);
  CHECK(closed["nodes"].empty());
  CHECK(row(window.state(), "Surfels").empty());
  window.screenshot("closed");
  window.key("ctrl+m");
  window.openFile(organMesh());
  C3DE_WAIT(window, "another one is there",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
}

TEST_CASE("surface and frame of the present state are exported through the menu", "[organ_export]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_export");
  startOrgan(window);
  const fs::path folder = c3de::test::outputFile("export");
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto save = [&](const std::string &entry, const fs::path &file) {
    window.click("menu/file");
    C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/" + entry));
    window.click("menu/" + entry);
    window.enterFile(file);
  };
  save("file.export_surface", folder / "now.stl");
  C3DE_WAIT(window, "it is written", s["notifications"].size() == 1);
  CHECK(window.state()["notifications"][0]["title"] == "Exported");
  REQUIRE(fs::exists(folder / "now.stl"));
  CHECK(fs::file_size(folder / "now.stl") > 84 + 50 * 100);  // more than a hundred triangles
  save("file.export_frame", folder / "now.pvd");
  window.waitUntil("the frame is there", [&](const Json &) { return fs::exists(folder / "now.pvd"); });
  CHECK(fs::exists(folder / "now_frames" / "points_000000.vtu"));
  CHECK(fs::exists(folder / "now_frames" / "skin_000000.vtp"));
  // An existing file is replaced only after a second press.
  const auto before = fs::last_write_time(folder / "now.stl");
  save("file.export_surface", folder / "now.stl");
  const Json asked = C3DE_WAIT(window, "the dialog asks", s["values"].contains("dialog/error"));
  CHECK_THAT(asked["values"]["dialog/error"].get<std::string>(), Contains("now.stl") && Contains("replace"));
  window.screenshot("asks");
  CHECK(fs::last_write_time(folder / "now.stl") == before);
  window.click("dialog/open");
  window.waitUntil("it is replaced", [&](const Json &) { return fs::last_write_time(folder / "now.stl") != before; });
  CHECK(window.isRunning());
}

/// Chooses an item of a list in the panel and checks the picture once it is drawn.
void choose(WorkstationDriver &window, const std::string &parameter, const std::string &item) {
  window.click(kPanel + parameter);
  window.click(kPanel + parameter + ".option." + item);
  C3DE_WAIT(window, parameter + " is " + item, row(s, parameter.c_str()) == item);
  window.moveTo(window.inView(0.95, 0.95));
  window.waitFrames(1);
}

TEST_CASE("the surface can be made transparent, with evaluation points or phyxels inside", "[organ_surface]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_surface");
  startOrgan(window);
  choose(window, "view.surface", "opaque");
  window.screenshot("opaque");
  choose(window, "view.surface", "transparent");
  window.screenshot("transparent");
  CHECK(window.value(std::string(kPanel) + "view.points") == "evaluation_points");
  CHECK(window.differingPixels("opaque", "transparent") > 10000);
  choose(window, "view.points", "phyxels");
  window.screenshot("phyxels");
  CHECK(window.differingPixels("transparent", "phyxels") > 3000);
  choose(window, "view.surface", "hidden");
  window.screenshot("points_only");
  CHECK(window.differingPixels("phyxels", "points_only") > 10000);
  choose(window, "view.surface", "opaque");
  window.screenshot("again");
  CHECK(window.differingPixels("opaque", "again") < 500);
}

TEST_CASE("an organ is coloured by its stress and its error with a legend, and plain again", "[organ_colours]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_colours");
  startOrgan(window);
  window.key("p");
  window.click("toolbar/play");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  window.moveTo(window.inView(0.5, 0.5));
  window.press();
  C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty());
  for (int i = 1; i <= 6; ++i) window.moveTo(window.inView(0.5 + 0.02 * i, 0.5 - 0.02 * i));
  C3DE_WAIT(window, "the hand pulls", std::strtod(row(s, "Pinch force").c_str(), nullptr) > 0.2);
  window.key("space");
  const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.release();
  C3DE_WAIT(window, "it is let go", row(s, "Pinch force") == "–");
  const std::string hash = row(window.state(), "State hash");
  choose(window, "view.colour", "material");
  window.screenshot("plain");
  CHECK(row(window.state(), "Colours").empty());

  choose(window, "view.colour", "von_mises");
  const Json stressed = C3DE_WAIT(window, "the legend says kPa", row(s, "Colours").find("kPa") != std::string::npos);
  CHECK_THAT(row(stressed, "Colours"), Contains("von Mises") && Contains("0 … "));
  CHECK_THAT(row(stressed, "Shown"), Contains("largest"));
  window.screenshot("von_mises");
  CHECK(window.differingPixels("plain", "von_mises") > 20000);

  choose(window, "view.colour", "error");
  C3DE_WAIT(
      window, "the legend says %",
      row(s, "Colours").find("error") != std::string::npos && row(s, "Shown").find("whole body") != std::string::npos);
  window.screenshot("error");
  CHECK(window.differingPixels("von_mises", "error") > 5000);

  // A fixed range: the legend ends at the specified value.
  window.click(std::string(kPanel) + "view.range.auto");
  C3DE_WAIT(window, "a number stands there", row(s, "view.range") != "auto");
  window.controlClick(std::string(kPanel) + "view.range");
  window.key("ctrl+a");
  window.type("7");
  window.key("Return");
  C3DE_WAIT(window, "the range is fixed", row(s, "Colours").find("0 … 7 %") != std::string::npos);
  window.screenshot("error_fixed");

  window.moveTo(window.inView(0.5, 0.9));
  window.key("ctrl+z");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the range is as before", row(s, "view.range") == "auto");
  choose(window, "view.colour", "material");
  C3DE_WAIT(window, "there is no legend", row(s, "Colours").empty());
  window.screenshot("again");
  CHECK(window.differingPixels("plain", "again") < 500);
  // Changing the view changes no state.
  CHECK(row(window.state(), "State hash") == hash);
  CHECK(window.state()["transport"]["steps"] == paused["transport"]["steps"]);
}

TEST_CASE("a change of the material is undone and redone, and the solver follows", "[organ_undo]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_undo");
  startOrgan(window);
  const std::string modulus = std::string(kPanel) + "material.youngs_modulus";
  const std::string before = window.value(modulus);
  const double stepBefore = window.number(std::string(kPanel) + "Step size");
  const Point at = window.locate(modulus);
  window.drag(at, {at.x + 40, at.y}, 4);
  const Json dragged = C3DE_WAIT(window, "the drag has changed it", row(s, "material.youngs_modulus") != before);
  const std::string after = row(dragged, "material.youngs_modulus");
  C3DE_WAIT(window, "the step follows", std::stod(row(s, "Step size")) < 0.9 * stepBefore);

  window.click("menu/edit");
  window.screenshot("menu");
  window.key("Escape");
  C3DE_WAIT(window, "the menu is closed", !s["widgets"].contains("menu/edit.undo"));
  window.moveTo(window.inView(0.5, 0.9));
  window.key("ctrl+z");
  window.waitForValue(modulus, before);
  C3DE_WAIT(window, "the step is as before", std::stod(row(s, "Step size")) == stepBefore);
  window.key("ctrl+y");
  window.waitForValue(modulus, after);
}

TEST_CASE("an organ from a scene can be filled again with another count", "[organ_rebuild]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_rebuild");
  startOrgan(window);
  CHECK_THAT(window.number(std::string(kPanel) + "Phyxels"), WithinRel(400.0, 0.1));
  window.controlClick(std::string(kPanel) + "sampling.count");
  window.key("ctrl+a");
  window.type("200");
  window.key("Return");
  window.waitForValue(std::string(kPanel) + "sampling.count", "200");
  window.click(std::string(kPanel) + "rebuild");
  const Json state = C3DE_WAIT(window, "it is filled again or refused",
                               !s["notifications"].empty() || std::stod(row(s, "Phyxels")) < 300.0);
  CHECK(state["notifications"].empty());
  CHECK_THAT(window.number(std::string(kPanel) + "Phyxels"), WithinRel(200.0, 0.1));
}

namespace {

// Nearly incompressible in implicit steps: many seconds for each.
fs::path heavyScene(const std::string &solver, int count = 12000) {
  fs::path scene = c3de::test::outputFile("heavy_" + std::to_string(count) + ".toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Heavy organ\"\n[solver]\nintegrator = \"implicit\"\n"
      << solver << "\n[[body]]\n"
      << "name = \"organ\"\nmesh = \"" << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 2e6, poisson_ratio = 0.499, density = 1000.0 }\n"
      << "sampling = { count = " << count << " }\nangular_velocity = [0.0, 0.0, 40.0]\n";
  return scene;
}

}  // namespace

TEST_CASE("a step that takes long is said while it lasts, and reset and Escape end it", "[organ_long_step]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path scene = heavyScene("step_budget = 300.0");
  WorkstationDriver window("organ_long_step");
  window.start({scene.string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"] == true);
  window.moveTo(window.inView(0.9, 0.1));
  const auto isLong = [](const Json &s) { return s["values"].contains("status/long_step"); };
  const auto waitForLongStep = [&] {
    return C3DE_WAIT(window, "the long step is said", isLong(s) && s["transport"]["step_running_s"] > 2.0);
  };
  window.key("space");
  const Json busy = waitForLongStep();
  const std::string line = busy["values"]["status/long_step"];
  CHECK_THAT(line, Contains("Step running for") && Contains("organ") && Contains("0.499") && Contains("would help"));
  CHECK(busy["transport"]["real_time_factor"] < 0.05);
  CHECK(busy["transport"]["step_ms"] > 1000.0);
  window.screenshot("long_step");

  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point since) {
    return std::chrono::duration<double>(Clock::now() - since).count();
  };
  // Reset continues to play: a new step begins.
  const Clock::time_point reset = Clock::now();
  window.key("ctrl+r");
  C3DE_WAIT(window, "another step has begun", !isLong(s));
  CHECK(seconds(reset) < 2.0 * C3DE_UI_PATIENCE);
  waitForLongStep();
  const Clock::time_point escape = Clock::now();
  window.key("Escape");
  const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  CHECK(seconds(escape) < 2.0 * C3DE_UI_PATIENCE);
  CHECK(paused["transport"]["steps"] == 0);
}

TEST_CASE("a step beyond its budget is given up, with what would fit, and nothing is lost", "[organ_step_budget]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_step_budget");
  window.start({heavyScene("step_budget = 1.0").string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"] == true);
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  const Json said = C3DE_WAIT(window, "the step is said to take long", s["values"].contains("status/long_step"));
  CHECK_THAT(said["values"]["status/long_step"].get<std::string>(), Contains("abandoned after 1 s"));
  const auto isGivenUp = [](const Json &s) { return mode(s) == "paused" && !s["notifications"].empty(); };
  const Json paused = window.waitUntil("it is given up", isGivenUp);
  const std::string text = paused["notifications"].back()["text"];
  CHECK_THAT(text, Contains("abandoned after 1 s (“Time for a step”)") && Contains("organ"));
  CHECK_THAT(text, Contains("Newton step") && Contains("measured") && Contains("“Count” = "));
  CHECK(paused["transport"]["steps"] == 0);
  window.screenshot("given_up");

  // Coarser, it runs: far below the proposed sampling, so that a busy machine manages it as well.
  window.controlClick(std::string(kPanel) + "sampling.count");
  window.key("ctrl+a");
  window.type("200");
  window.key("Return");
  window.click(std::string(kPanel) + "rebuild");
  C3DE_WAIT(window, "it is filled again", std::stod(row(s, "Phyxels")) < 300.0);
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  C3DE_WAIT(window, "it moves", s["transport"]["steps"] > 2);
}

TEST_CASE("while a hand holds it no step is given up, and the status bar says that it is slow", "[organ_hand_budget]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_hand_budget");
  // No step fits into this budget.
  window.start({heavyScene("step_budget = 0.01", 1000).string()});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
  const Point from = window.inView(0.5, 0.5);
  window.moveTo(from);
  window.press();
  C3DE_WAIT(window, "it is held", !row(s, "Held surfel").empty());
  window.key("space");
  for (int i = 1; i <= 8; ++i) window.moveTo({from.x + 6 * i, from.y - 6 * i});
  // Software drawing and other programs use processor time as well.
  const Json slow = C3DE_WAIT(
      window, "it plays, slowly",
      s["transport"]["steps"] >= 3 && s["values"].value("status/rate", "").starts_with("slower than real time: "));
  CHECK(mode(slow) == "playing");
  const auto isGivenUp = [](const Json &s) {
    return s["notifications"].dump().find("Paused: a step took too long") != std::string::npos;
  };
  CHECK_FALSE(isGivenUp(slow));
  window.screenshot("slow");

  // Escape ends the hold; without it the budget counts again.
  window.key("Escape");
  C3DE_WAIT(window, "it is released", row(s, "Held surfel").empty());
  window.release();
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const int steps = window.state()["transport"]["steps"];
  window.key("space");
  const Json paused = C3DE_WAIT(window, "the step is given up", isGivenUp(s) && mode(s) == "paused");
  CHECK(paused["transport"]["steps"] == steps);
}

TEST_CASE("an organ that plays is made stiff and nearly incompressible, and goes on", "[organ_stiff_edit]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path scene = c3de::test::outputFile("stiff_edit.toml");
  std::ofstream(scene) << "format = 1\n[solver]\nintegrator = \"implicit\"\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
                       << "material = { law = \"neo_hookean\", youngs_modulus = 1e4, poisson_ratio = 0.4, density = "
                          "1000.0 }\nsampling = { count = 989 }\nangular_velocity = [0.0, 0.0, 20.0]\n";
  WorkstationDriver window("organ_stiff_edit");
  window.start({scene.string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"] == true);
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  C3DE_WAIT(window, "it plays", s["transport"]["steps"] > 5);
  for (const auto &[id, value] :
       {std::pair("material.poisson_ratio", "0.499"), std::pair("material.youngs_modulus", "2e6")}) {
    window.controlClick(std::string(kPanel) + id);
    window.key("ctrl+a");
    window.type(value);
    window.key("Return");
  }
  const Json edited = window.state();
  const int steps = edited["transport"]["steps"];
  window.moveTo(window.inView(0.9, 0.1));
  std::map<int, double> shownAt_s;
  const auto look = [&shownAt_s](const Json &s) {
    for (const Json &a : s.value("answers", Json::array())) shownAt_s[a[0].get<int>()] = a[4].get<double>();
  };
  look(edited);
  // It continues, or reports that it was given up; it does not hang, and nothing fails.
  window.waitUntil("it goes on, or was given up", [&](const Json &s) {
    look(s);
    return s["transport"]["steps"] > steps + 5 || (mode(s) == "paused" && !s["notifications"].empty());
  });
  double longest_s = 0.0;
  for (auto one = shownAt_s.begin(), next = one; one != shownAt_s.end() && ++next != shownAt_s.end(); one = next)
    if (next->first == one->first + 1) longest_s = std::max(longest_s, next->second - one->second);
  WARN("from the edits on the longest frame of " << shownAt_s.size() << " took " << 1e3 * longest_s << " ms");
  window.screenshot("stiff");
  window.key("ctrl+r");
  const Json reset = C3DE_WAIT(window, "it begins again", s["transport"]["steps"] < steps);
  CHECK(mode(reset) != "failed");
}

TEST_CASE("quitting asks once a simulation has run, and Enter and Escape answer", "[organ_quit]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_quit");
  startOrgan(window);
  window.key("space");
  C3DE_WAIT(window, "it plays", s["transport"]["steps"] > 5);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const auto isAsked = [](const Json &s) { return s["values"].contains("quit/text"); };
  window.key("ctrl+q");
  const Json asked = window.waitUntil("it asks", isAsked);
  CHECK_THAT(asked["values"]["quit/text"].get<std::string>(), Contains("has run to t = "));
  window.screenshot("asked");
  window.key("Escape");
  C3DE_WAIT(window, "it goes on", !isAsked(s));
  CHECK(window.isRunning());
  CHECK(window.state()["transport"]["steps"] > 5);
  window.key("ctrl+q");
  window.waitUntil("it asks again", isAsked);
  window.key("Return");
  CHECK(window.waitForExit() == 0);
}

TEST_CASE("quitting asks nothing while nothing would be lost", "[organ_quit]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_quit_at_start");
  startOrgan(window);
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
}

/// Plays, pulls the centre of the organ towards the upper right and holds it there.
void pull(WorkstationDriver &window) {
  window.key("p");
  C3DE_WAIT(window, "the pinch tool is active", s["tool"] == "pointbased.pinch");
  const Point from = window.inView(0.5, 0.5);
  window.moveTo(from);
  window.press();
  C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty());
  for (int i = 1; i <= 6; ++i) window.moveTo({from.x + 18.0 * i, from.y - 16.0 * i});
  C3DE_WAIT(window, "the hand pulls", std::strtod(row(s, "Pinch force").c_str(), nullptr) > 0.2);
}

TEST_CASE("a pull is undone by one step, back to the state before it, and done again", "[organ_undo_pull]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_undo_pull");
  startOrgan(window);
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  pull(window);
  window.waitFrames(30);
  window.release();
  window.moveTo(window.inView(0.9, 0.9));
  window.key("space");
  const Json paused = C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  const auto steps = [](const Json &s) { return s["transport"]["steps"].get<long long>(); };
  C3DE_WAIT(window, "its state is shown", row(s, "Steps") == std::to_string(steps(paused)));
  const std::string pulled = row(window.state(), "State hash");
  window.screenshot("pulled");

  window.key("ctrl+z");
  const Json before =
      C3DE_WAIT(window, "the pull is undone", steps(s) < steps(paused) && row(s, "Steps") == std::to_string(steps(s)));
  CHECK(mode(before) == "paused");
  CHECK(before["transport"]["time_s"] < paused["transport"]["time_s"]);
  window.screenshot("undone");
  CHECK(window.differingPixels("pulled", "undone") > 300);
  window.key("ctrl+y");
  C3DE_WAIT(window, "the pull is done again", steps(s) == steps(paused) && row(s, "State hash") == pulled);

  // Undo during a pull releases the grab, and undoes that pull.
  window.key("space");
  C3DE_WAIT(window, "it plays on", mode(s) == "playing" && steps(s) > steps(paused) + 5);
  pull(window);
  const long long late = steps(window.state());
  C3DE_WAIT(window, "it is pulled for a while", steps(s) > late + 200);
  window.key("ctrl+z");
  C3DE_WAIT(window, "the hand has let go", row(s, "Held surfel").empty());
  window.release();
  window.moveTo(window.inView(0.9, 0.9));

  // A reset starts a new history: nothing can be undone.
  window.key("space");
  window.key("ctrl+r");
  C3DE_WAIT(window, "it begins anew", steps(s) == 0 && row(s, "Steps") == "0");
  window.key("ctrl+z");
  window.waitFrames(2);
  CHECK(steps(window.state()) == 0);
}

TEST_CASE("a reset while something is pinched ends the pinch", "[organ_pinch_reset]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_pinch_reset");
  startOrgan(window);
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 5);
  const auto isReleased = [](const Json &s) { return row(s, "Held surfel").empty() && row(s, "Pinch force") == "–"; };
  pull(window);
  window.key("ctrl+r");
  window.waitUntil("the grip is gone with the state", isReleased);
  // The mouse moves on, and holds nothing.
  window.moveTo(window.inView(0.3, 0.3));
  const Json after = window.state();
  CHECK(isReleased(after));
  window.release();
  // The next one holds again.
  pull(window);
  window.key("space");
  C3DE_WAIT(window, "it pauses", mode(s) == "paused");
  window.key("ctrl+r");
  window.waitUntil("also while it stands", isReleased);
  window.screenshot("let_go");
  window.release();
}

TEST_CASE("a plugin's force field pulls an organ of the point-based plugin, live by its parameter", "[organ_magnet]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string magnet =
      (fs::path(testExampleFolder()) / (std::string("magnet") + c3de::pluginExtension())).string();
  if (!fs::exists(magnet)) C3DE_SKIP("the magnet is not built");
  constexpr const char *kStrength = "org.c3de.magnet.panel/strength", *kPulls = "org.c3de.magnet.panel/Pulls with";
  WorkstationDriver window("organ_magnet");
  window.start({floatingOrgan().string(), "--plugin", magnet});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing");
  CHECK(window.value(kPulls) == "0 N on 0 points");
  window.screenshot("before");

  const Point at = window.locate(kStrength);
  window.drag(at, {at.x + 40, at.y}, 4);
  const auto force = [&](const Json &s) { return std::strtod(s["values"].value(kPulls, "0").c_str(), nullptr); };
  const Json pulled = C3DE_WAIT(window, "it pulls", force(s) > 0.0);
  const std::string hash = row(pulled, "State hash");
  C3DE_WAIT(window, "the organ follows", row(s, "State hash") != hash);
  const double near =
      force(C3DE_WAIT(window, "it comes nearer, so that it is pulled harder", force(s) > 1.2 * force(pulled)));
  CHECK(near > 0.0);
  window.screenshot("after");
  CHECK(window.differingPixels("before", "after") > 500);

  window.key("ctrl+z");
  C3DE_WAIT(window, "without the force it is off", force(s) == 0.0);
  CHECK(window.state()["messages"].empty());
}

TEST_CASE("a wish for accuracy samples the organ anew and shows what to expect", "[organ_accuracy]") {
  C3DE_ORGAN_OR_SKIP();
  constexpr const char *kPercent = "accuracy.error_percent", *kBudget = "accuracy.budget_ms";
  const fs::path scene = c3de::test::outputFile("wished.toml");
  std::ofstream(scene) << "format = 1\n[world]\ngravity = [0.0, -9.81, 0.0]\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\nmaterial = \"liver\"\n"
                       << "[[fix]]\nregion = { half_space = { point = [-0.05, 0, 0], normal = [1, 0, 0] } }\n";
  WorkstationDriver window("organ_accuracy");
  window.start({scene.string()});
  C3DE_WAIT(window, "the organ is shown", s["jobs"].empty() && row(s, "Displacement").find("±") != std::string::npos);
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  CHECK(row(window.state(), "Tissue stiffness") == "1 … 15 kPa");
  const double before = window.number(std::string(kPanel) + "Phyxels");

  const auto wish = [&](const char *parameter, const std::string &value) {
    if (row(window.state(), parameter) == "auto") window.click(std::string(kPanel) + parameter + ".auto");
    C3DE_WAIT(window, "a number can be given", row(s, parameter) != "auto");
    window.controlClick(std::string(kPanel) + parameter);
    window.key("ctrl+a");
    window.type(value);
    window.key("Return");
    C3DE_WAIT(window, "the number is taken", std::stod("0" + row(s, parameter)) == std::stod(value));
    const std::string hash = row(window.state(), "Phyxels");
    window.click(std::string(kPanel) + "apply_wish");
    return C3DE_WAIT(window, "the organ is sampled anew",
                     s["jobs"].empty() && !row(s, "Phyxels").empty() && row(s, "Phyxels") != hash);
  };
  const Json accurate = wish(kPercent, "0.4");
  CHECK(std::stod(row(accurate, "Phyxels")) > 2.0 * before);
  window.locate(std::string(kPanel) + "rebuild");  // below the bars
  window.screenshotAtRest("error");
  // Another accuracy target replaces the first one.
  const Json quick = wish(kBudget, "0.5");
  CHECK(std::stod(row(quick, "Phyxels")) < std::stod(row(accurate, "Phyxels")));
  CHECK(row(quick, kPercent) == "auto");
  window.key("space");
  C3DE_WAIT(window, "it plays within its budget", row(s, "Frame time").find("now") != std::string::npos);
  window.screenshot("budget");
  CHECK(window.state()["messages"].empty());
}

TEST_CASE("inertia that explicit steps ask for is told, and goes with them", "[organ_inertia]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path scene = c3de::test::outputFile("inertia.toml");
  std::ofstream(scene)
      << "format = 1\n[world]\ngravity = [0.0, -9.81, 0.0]\n[solver]\nintegrator = \"explicit\"\n[[body]]\nname = "
         "\"organ\"\nmesh = \""
      << organMesh().generic_string()
      << "\"\nmesh_unit = \"mm\"\nmaterial = \"liver\"\nsampling = { count = 1500, adaptive = \"on\" }\n"
         "parts = [ { region = { sphere = { centre = [-0.048, 0, 0], radius = 0.004 } }, material = { youngs_modulus "
         "= 1e8 } } ]\n"
         "[[fix]]\nregion = { half_space = { point = [-0.05, 0, 0], normal = [1, 0, 0] } }\n";
  WorkstationDriver window("organ_inertia");
  window.start({scene.string()});
  const auto isTold = [](const Json &s) {
    return row(s, "Added inertia").find(" % of what can move, to ") != std::string::npos;
  };
  const Json made = C3DE_WAIT(window, "the organ is shown", s["jobs"].empty() && !row(s, "Halved cells").empty());
  CHECK(isTold(made));
  const std::string mass = row(made, "Mass");
  window.locate(std::string(kPanel) + "view.surface");  // below it
  window.screenshotAtRest("told");
  const auto choose = [&](const std::string &integrator) {
    window.click(std::string(kPanel) + "solver.integrator");
    window.click(std::string(kPanel) + "solver.integrator.option." + integrator);
  };
  choose("implicit");
  const Json implicit = C3DE_WAIT(window, "it is gone", !isTold(s));
  CHECK(row(implicit, "Mass") == mass);
  choose("explicit");
  window.waitUntil("it is there again", isTold);
}

TEST_CASE("a plugin's clamp and the pinch hold one organ; each lets go by itself", "[organ_clamp]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string clamp = (fs::path(testExampleFolder()) / (std::string("clamp") + c3de::pluginExtension())).string();
  if (!fs::exists(clamp)) C3DE_SKIP("the clamp is not built");
  constexpr const char *kClosed = "org.c3de.clamp.panel/closed", *kTurn = "org.c3de.clamp.panel/turn",
                       *kPulls = "org.c3de.clamp.panel/Pulls with", *kTurns = "org.c3de.clamp.panel/Turns with";
  WorkstationDriver window("organ_clamp");
  window.start({floatingOrgan().string(), "--plugin", clamp});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing");
  const auto number = [](const Json &s, const char *of) {
    return std::strtod(s["values"].value(of, "0").c_str(), nullptr);
  };
  window.click(kClosed);
  const Point turn = window.locate(kTurn);
  window.drag(turn, {turn.x + 40, turn.y}, 4);
  C3DE_WAIT(window, "it turns", number(s, kTurns) > 0.0);
  window.screenshot("turned");

  // The pinch grabs a region that the clamp already holds.
  window.moveTo(window.inView(0.5, 0.5));
  window.key("p");
  const Point at = window.inView(0.5, 0.5);
  window.moveTo(at);
  window.press();
  window.moveTo({at.x + 60, at.y + 40});
  C3DE_WAIT(window, "both pull",
            number(s, kPulls) > 0.0 && row(s, "Pinch force") != "–" && !row(s, "Pinch force").empty());
  window.screenshot("both");
  window.release();
  C3DE_WAIT(window, "the pinch has let go", row(s, "Pinch force") == "–");
  C3DE_WAIT(window, "the clamp has not", number(s, kPulls) > 0.0);
  window.click(kClosed);
  C3DE_WAIT(window, "the clamp has let go, too", number(s, kPulls) == 0.0);
  CHECK(window.state()["messages"].empty());
}

TEST_CASE("a command of a plugin stands in the menu and answers its keys; where it fails its text is shown",
          "[commands]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string samples =
      (fs::path(testExampleFolder()) / (std::string("image_samples") + c3de::pluginExtension())).string();
  if (!fs::exists(samples)) C3DE_SKIP("image_samples is not built");
  constexpr const char *kEntry = "menu/plugins.org.c3de.image_samples.log";
  WorkstationDriver window("commands");
  window.start({floatingOrgan().string(), "--plugin", samples});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() && !row(s, "Surfels").empty());
  window.click("menu/plugins");
  C3DE_WAIT(window, "the menu is open", s["widgets"].contains(kEntry));
  window.screenshot("menu");
  window.click(kEntry);
  const auto told = [](const Json &s) {
    return s["notifications"].dump().find("there is no image") != std::string::npos;
  };
  window.waitUntil("the menu has run it, and its text is shown", told);
  window.screenshot("told");
  window.click("notification/close.0");
  C3DE_WAIT(window, "the message is closed", s["notifications"].empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("ctrl+shift+l");
  CHECK(window.waitUntil("the keys have run it", told)["notifications"].size() == 1);
}
