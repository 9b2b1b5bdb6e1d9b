// SPDX-License-Identifier: Apache-2.0
// User actions with an instrument and an implant in the window.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// An organ held by its surroundings, with a plate above it.
fs::path heldOrgan() {
  const fs::path folder = fs::path(testOutputRoot()) / "ui";
  fs::create_directories(folder);
  std::ofstream plate(folder / "plate.obj");
  for (const double x : {-40.0, 40.0})
    for (const double y : {56.0, 64.0})
      for (const double z : {-20.0, 20.0}) plate << "v " << x << ' ' << y << ' ' << z << '\n';
  plate
      << "f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8\nf 2 8 4\n";
  std::ofstream(folder / "held.toml")
      << "format = 1\ntitle = \"Held organ\"\n[solver]\ndamping = 10.0\n[[body]]\nname = \"organ\"\nmesh = \""
      << organMesh().generic_string()
      << "\"\nmesh_unit = \"mm\"\nmaterial = { youngs_modulus = 6e3, poisson_ratio = 0.4 }\n"
         "sampling = { count = 400 }\n"
         "[[attachment]]\nname = \"around\"\nbodies = [\"organ\", \"surroundings\"]\nstiffness = 5e4\n"
         "[[obstacle]]\nname = \"plate\"\nmesh = \"plate.obj\"\nmesh_unit = \"mm\"\n";
  return folder / "held.toml";
}

void openHeldOrgan(WorkstationDriver &window) {
  openOrgan(window, {heldOrgan().string()});
  C3DE_WAIT(window, "the plate is there", s["nodes"].size() >= 3);
  window.key("f");
}

double number(const Json &state, const std::string &name) { return std::strtod(row(state, name).c_str(), nullptr); }

void rest(WorkstationDriver &window, double seconds) {
  const double from = window.state()["transport"]["time_s"];
  C3DE_WAIT(window, "it comes to rest", s["transport"]["time_s"].get<double>() > from + seconds);
}

}  // namespace

TEST_CASE("an instrument is pressed into an organ, felt, undone and taken away", "[hands_touch]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_touch");
  openHeldOrgan(window);
  window.key("t");
  C3DE_WAIT(window, "the touch tool is active", s["tool"] == "pointbased.touch");
  play(window);
  const Json camera = window.state()["camera"];
  const Point at = window.inView(0.45, 0.55);
  window.moveTo(at);
  window.press();
  C3DE_WAIT(window, "an instrument is there", row(s, "Contact area").ends_with("mm²"));
  window.wheel(6);
  C3DE_WAIT(window, "it is felt", number(s, "Contact force") > 0.1);
  window.moveTo({at.x + 20, at.y - 20});
  window.release();
  rest(window, 2.0);
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshot("pressed");
  CHECK(window.state()["camera"] == camera);
  // At rest the surroundings hold the organ against the instrument.
  const Json pressed = window.state();
  const double force = number(pressed, "Contact force");
  CHECK(force > 0.1);
  CHECK(std::abs(number(pressed, "organ = surroundings") - force) < 0.01 * force);
  CHECK(std::abs(number(pressed, "organ – instrument") - force) < 0.01 * force);

  window.key("d");
  window.key("d");
  C3DE_WAIT(window, "it is pushed deeper", number(s, "Contact force") > 1.1 * force);
  CHECK(window.state()["notifications"].empty());

  window.key("ctrl+z");
  C3DE_WAIT(window, "the touch is undone", row(s, "Contact force") == "–");
  window.key("ctrl+y");
  C3DE_WAIT(window, "it is done again", number(s, "Contact force") > 0.5 * force);
  window.key("x");
  C3DE_WAIT(window, "it is taken away", row(s, "Contact force") == "–");

  // A reset ends a continuing touch.
  window.moveTo(at);
  window.press();
  C3DE_WAIT(window, "an instrument is there", row(s, "Contact area").ends_with("mm²"));
  window.key("ctrl+r");
  C3DE_WAIT(window, "it has gone", row(s, "Contact force") == "–");
  window.release();
}

TEST_CASE("an implant is moved by its handles and by numbers, presses, and is put back by Undo", "[hands_implant]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_implant");
  openHeldOrgan(window);
  window.key("m");
  C3DE_WAIT(window, "the move tool is active", s["tool"] == "pointbased.move");
  // Before the first step it is placed immediately.
  window.choose(kPanel + "placed", "plate");
  window.waitForValue(kPanel + "placed_y", "60 mm");
  window.enterNumber(kPanel + "placed_y", "58");
  window.waitForValue(kPanel + "placed_y", "58 mm");
  window.screenshot("placed");
  window.enterNumber(kPanel + "placed_turn_z", "5");
  window.waitForValue(kPanel + "placed_turn_z", "5 °");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is turned back", std::abs(number(s, "placed_turn_z")) < 1e-6);
  CHECK(row(window.state(), "placed_y") == "58 mm");

  play(window);
  window.enterNumber(kPanel + "placed_y", "48");
  C3DE_WAIT(window, "it presses", number(s, "Contact force on plate") > 0.2);
  rest(window, 2.0);
  const Json pressed = window.state();
  const double force = number(pressed, "Contact force on plate");
  CHECK(std::abs(number(pressed, "organ = surroundings") - force) < 0.01 * force);
  CHECK(number(pressed, "Contact area on plate") > 50.0);
  // Some of the organ was there, and no more than the volume of the plate.
  CHECK(number(pressed, "Displaced on plate") > 0.1);
  CHECK(number(pressed, "Displaced on plate") < 25.6);
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshot("pressing");
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is where it was", row(s, "placed_y") == "58 mm" && number(s, "Contact force on plate") == 0.0);
  window.screenshot("undone");
  CHECK(window.differsFrom("pressing", "undone", 300));

  // Removed where nothing obstructs it, it returns there, and the simulated history is unchanged.
  const auto hasPlate = [](const Json &s) {
    return std::any_of(s["nodes"].begin(), s["nodes"].end(), [](const Json &node) { return node["name"] == "plate"; });
  };
  const auto choose = [&] { window.choose(kPanel + "placed", "plate"); };
  const auto undo = [&](const char *key, bool isThere) {
    window.moveTo(window.inView(0.9, 0.9));
    window.key(key);
    C3DE_WAIT(window, "it has come or gone", hasPlate(s) == isThere);
  };
  window.enterNumber(kPanel + "placed_y", "61");
  C3DE_WAIT(window, "it has gone there", row(s, "placed_y") == "61 mm");
  rest(window, 0.5);
  const double steps = window.state()["transport"]["steps"];
  window.click(kPanel + "obstacle_remove");
  C3DE_WAIT(window, "it has gone", !hasPlate(s));
  undo("ctrl+z", true);
  choose();
  window.waitForValue(kPanel + "placed_y", "61 mm");
  CHECK(window.state()["transport"]["steps"] > steps);
  undo("ctrl+y", false);
  undo("ctrl+z", true);

  // The organ has meanwhile moved into its position: the simulation restarts, with the plate at its start.
  choose();
  window.enterNumber(kPanel + "placed_y", "48");
  C3DE_WAIT(window, "it presses", number(s, "Contact force on plate") > 0.2);
  rest(window, 1.0);
  window.click(kPanel + "obstacle_remove");
  C3DE_WAIT(window, "it has gone", !hasPlate(s));
  rest(window, 1.0);
  const double before = window.state()["transport"]["steps"];
  undo("ctrl+z", true);
  CHECK(window.state()["transport"]["steps"] < before);
  choose();
  window.waitForValue(kPanel + "placed_y", "58 mm");
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshot("back");
  const Json announced = window.state()["notifications"];
  REQUIRE(announced.size() == 1);
  CHECK(announced[0]["title"] == "The simulation has restarted");
}

TEST_CASE("an implant is added in the unit that is chosen, at the marked point, and the simulation keeps its state",
          "[hands_add_implant]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_add_implant");
  openHeldOrgan(window);
  // A cube of two inches, far from the organ, in a file without a unit.
  const fs::path file = outputFile("cube.obj");
  std::ofstream(file) << "v 300 0 0\nv 302 0 0\nv 300 2 0\nv 302 2 0\nv 300 0 2\nv 302 0 2\nv 300 2 2\nv 302 2 2\n"
                         "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\n"
                         "f 2 4 8\nf 2 8 6\n";
  play(window);
  rest(window, 0.3);
  window.click(kPanel + "obstacle_browse");
  window.openFile(file);
  C3DE_WAIT(window, "its unit is asked for", row(s, "Size") == "2.00 × 2.00 × 2.00 mm");
  window.choose(kPanel + "obstacle_unit", "inch");
  window.waitForValue(kPanel + "Size", "50.8 × 50.8 × 50.8 mm");
  window.screenshot("asked");
  // Next to the organ, at the pivot of the camera: the centre of the organ, without an image.
  const Json focus = window.state()["camera"]["focus"];
  CHECK(std::abs(std::strtod(row(window.state(), "Centre").c_str(), nullptr) - focus[0].get<double>()) < 0.06);
  // In metres the organ is inside it: a reset is announced, not performed.
  window.choose(kPanel + "obstacle_unit", "m");
  window.waitForValue(kPanel + "Size", "2000 × 2000 × 2000 mm");
  const double before = window.state()["transport"]["time_s"];
  window.click(kPanel + "obstacle_add");
  window.waitForValue(kPanel + "Tissue in the way", "organ");
  CHECK(window.state()["transport"]["time_s"].get<double>() > before);
  window.screenshot("announced");

  // At another position the state is unchanged: in centimetres the file places it 3 m away.
  window.choose(kPanel + "obstacle_unit", "cm");
  window.choose(kPanel + "obstacle_place", "as in the file");
  window.waitForValue(kPanel + "Centre", "3010.0  10.0  10.0 mm");
  const auto hasCube = [](const Json &s) {
    return std::any_of(s["nodes"].begin(), s["nodes"].end(), [](const Json &node) { return node["name"] == "cube"; });
  };
  const double at = window.state()["transport"]["time_s"];
  window.click(kPanel + "obstacle_add");
  const Json added = window.waitUntil("it is there", hasCube);
  CHECK(mode(added) == "playing");
  CHECK(added["transport"]["time_s"].get<double>() > at);
  CHECK_FALSE(added["widgets"].contains(kPanel + "obstacle_unit"));
  // A step of Undo.
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is undone", !hasCube(s));
  window.key("ctrl+y");
  const Json again = window.waitUntil("it is done again", hasCube);
  CHECK(again["transport"]["time_s"].get<double>() > at);
  CHECK(again["notifications"].empty());
}

TEST_CASE("shapes of the program are placed on the skin, in the size that was asked for", "[hands_shapes]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_shapes");
  openHeldOrgan(window);
  play(window);
  rest(window, 0.3);
  const auto hasNode = [](const Json &s, const std::string &name) {
    return std::any_of(s["nodes"].begin(), s["nodes"].end(), [&](const Json &node) { return node["name"] == name; });
  };
  // A plate on the skin that is nearest to the pivot of the camera.
  window.click(kPanel + "obstacle_new");
  window.waitForValue(kPanel + "obstacle_place", "on the nearest surface");
  window.enterNumber(kPanel + "obstacle_length", "60");
  C3DE_WAIT(window, "its length is taken", number(s, "obstacle_length") == 60.0);
  // In its own coordinates; the underside touches the skin.
  CHECK_THAT(row(window.state(), "Size"), Catch::Matchers::StartsWith("60.0 ×"));
  window.screenshot("plate");
  const Json focus = window.state()["camera"]["focus"];
  const std::string centre = row(window.state(), "Centre");
  window.click(kPanel + "obstacle_add");
  const Json added = C3DE_WAIT(window, "it is next to the plate of the scene", hasNode(s, "plate 2"));
  CHECK(mode(added) == "playing");
  CHECK(added["notifications"].empty());
  window.screenshot("placed");

  // A screw has the same place; a second plate has a name of its own.
  window.choose(kPanel + "obstacle_shape", "sphere");
  window.click(kPanel + "obstacle_new");
  window.waitForValue(kPanel + "New obstacle", "sphere");
  window.waitForValue(kPanel + "Size", "20.0 × 20.0 × 20.0 mm");
  // Its centre is half a diameter above the skin.
  CHECK(row(window.state(), "Centre") != centre);
  window.click(kPanel + "obstacle_cancel");
  window.choose(kPanel + "obstacle_shape", "plate");
  window.click(kPanel + "obstacle_new");
  window.waitForValue(kPanel + "New obstacle", "plate");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  C3DE_WAIT(window, "the plate is removed by Undo", !hasNode(s, "plate 2"));
}

TEST_CASE("undo of an obstacle that restarts the simulation restores the state before it", "[hands_restart_undo]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_restart_undo");
  openHeldOrgan(window);
  const fs::path file = outputFile("block.obj");
  std::ofstream(file) << "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 2 2 0\nv 0 0 2\nv 2 0 2\nv 0 2 2\nv 2 2 2\n"
                         "f 1 3 4\nf 1 4 2\nf 5 6 8\nf 5 8 7\nf 1 2 6\nf 1 6 5\nf 3 7 8\nf 3 8 4\nf 1 5 7\nf 1 7 3\n"
                         "f 2 4 8\nf 2 8 6\n";
  play(window);
  C3DE_WAIT(window, "it moves", s["transport"]["steps"] > 10);
  pause(window);
  const Json before = window.state();
  window.click(kPanel + "obstacle_browse");
  window.openFile(file);
  C3DE_WAIT(window, "its unit is asked for", row(s, "Size") == "2.00 × 2.00 × 2.00 mm");
  window.choose(kPanel + "obstacle_unit", "m");
  window.waitForValue(kPanel + "Size", "2000 × 2000 × 2000 mm");
  window.click(kPanel + "obstacle_add");
  window.waitForValue(kPanel + "Tissue in the way", "organ");
  window.click(kPanel + "obstacle_add");
  const auto hasBlock = [](const Json &s) {
    return std::any_of(s["nodes"].begin(), s["nodes"].end(), [](const Json &node) { return node["name"] == "block"; });
  };
  C3DE_WAIT(window, "it is added, and the simulation restarts", hasBlock(s) && s["transport"]["steps"] == 0);
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  C3DE_WAIT(window, "the state before it is restored",
            !hasBlock(s) && s["transport"]["steps"] == before["transport"]["steps"] &&
                row(s, "State hash") == row(before, "State hash"));
  window.key("ctrl+y");
  C3DE_WAIT(window, "it is added again", hasBlock(s) && s["transport"]["steps"] == 0);
}

TEST_CASE("jaws grasp an organ, close, pull and turn it, and Undo goes back step by step", "[hands_grasp]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("hands_grasp");
  openHeldOrgan(window);
  window.key("g");
  C3DE_WAIT(window, "the grasp tool is active", s["tool"] == "pointbased.grasp");
  play(window);
  const Json camera = window.state()["camera"];
  const Point at = window.inView(0.45, 0.55);
  window.moveTo({at.x - 30, at.y + 10});
  window.moveTo({at.x - 10, at.y});
  window.moveTo(at);
  window.press();
  C3DE_WAIT(window, "jaws hold", row(s, "Gap").ends_with("mm"));
  // The organ is coarse: jaws at their default settings hold two spacings, open to twice that and close by half.
  const double opening = number(window.state(), "grasp_opening");
  C3DE_WAIT(window, "they have closed", number(s, "Gap") < 0.6 * opening);
  rest(window, 1.0);
  window.moveTo(window.inView(0.45, 0.55));
  window.screenshot("closed");
  const Json closed = window.state();
  CHECK(number(closed, "Squeezing force") > 0.02);
  CHECK(std::abs(number(closed, "Gap") - number(closed, "grasp_closed")) < 0.2);

  for (int k = 1; k <= 6; ++k) window.moveTo({at.x + 5 * k, at.y - 10 * k});
  C3DE_WAIT(window, "they pull", number(s, "Pull force") > 0.2);
  window.release();
  rest(window, 2.0);
  window.screenshot("pulled");
  CHECK(window.state()["camera"] == camera);
  // At rest the surroundings hold the organ against the jaws, which remain.
  const Json pulled = window.state();
  const double pull = number(pulled, "Pull force");
  CHECK(pull > 0.2);
  CHECK(std::abs(number(pulled, "organ = surroundings") - pull) < 0.02 * pull);
  CHECK(window.differsFrom("closed", "pulled", 300));

  // Another drag on a jaw continues, and the wheel rotates both; outside the jaws nothing would have rotated.
  const Json view = window.state()["view"];
  const double perPixel =
      2.0 * camera["distance"].get<double>() * std::tan(0.3) / view["h"].get<double>();  // mm, in the focus
  const Point jaw{at.x + 30 + 0.5 * number(pulled, "Gap") / perPixel, at.y - 60};
  window.moveTo(jaw);
  window.press();
  window.wheel(4);
  C3DE_WAIT(window, "they turn", row(s, "Pull x, y, z") != row(pulled, "Pull x, y, z"));
  CHECK(number(window.state(), "Gap") < 0.6 * opening);  // it is still the same grasp
  const std::string turned = row(window.state(), "Pull x, y, z");
  for (int k = 1; k <= 3; ++k) window.moveTo({jaw.x + 10 * k, jaw.y});
  C3DE_WAIT(window, "it pulls elsewhere", row(s, "Pull x, y, z") != turned);
  window.release();
  rest(window, 2.0);
  window.screenshot("turned");
  CHECK(window.state()["camera"] == camera);
  CHECK(window.differsFrom("pulled", "turned", 300));
  // Escape belongs to drags; the jaws remain.
  window.key("Escape");
  window.waitFrames(2);
  CHECK(row(window.state(), "Pull force") != "–");

  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+z");
  rest(window, 1.0);
  const Json undone = window.state();
  CHECK(std::abs(number(undone, "Pull force") - pull) < 0.05 * pull);
  window.key("ctrl+z");
  C3DE_WAIT(window, "the grasp is undone", row(s, "Pull force") == "–");
  window.key("ctrl+y");
  C3DE_WAIT(window, "it holds again", number(s, "Pull force") > 0.5 * pull);
  CHECK(window.state()["notifications"].empty());
  window.key("x");
  C3DE_WAIT(window, "they let go", row(s, "Pull force") == "–");

  // A failed grasp is reported.
  window.enterNumber(kPanel + "grasp_opening", "120");
  window.moveTo(at);
  window.press();
  C3DE_WAIT(window, "it is told", !s["notifications"].empty());
  window.release();
  window.screenshot("told");
  const std::string told = window.state()["notifications"].dump();
  INFO(told);
  CHECK((told.find("misses the body") != std::string::npos || told.find("wide there") != std::string::npos));
}
