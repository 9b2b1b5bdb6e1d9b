// SPDX-License-Identifier: Apache-2.0
// A simulator of another kind in the window: shown, pulled by the mouse, released.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

fs::path floatingSprings() {
  const fs::path scene = outputFile("springs.toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Springs\"\n[simulator]\nclass = \"org.c3de.mass_spring.Simulator/0\"\n"
                          "[world]\ngravity = [0.0, 0.0, 0.0]\n[solver]\ndamping = 5.0\n"
                          "[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string()
                       << "\"\nmesh_unit = \"mm\"\nsampling = { count = 800 }\n"
                          "[[fix]]\nregion = { half_space = { point = [-0.04, 0, 0], normal = [1, 0, 0] } }\n";
  return scene;
}

double pull(const Json &state) {
  return std::strtod(state["values"].value("org.c3de.mass_spring.panel/Pull", "").c_str(), nullptr);
}

}  // namespace

TEST_CASE("an organ of masses and springs is shown, follows the hand and is let go", "[springs_pull]") {
  C3DE_WINDOW_OR_SKIP();
  WorkstationDriver window("springs_pull");
  const std::string plugin = examplePlugin("mass_spring");
  window.start({floatingSprings().string(), "--plugin", plugin});
  C3DE_WAIT(window, "the organ is shown",
            s["transport"]["exists"].get<bool>() && s["jobs"].empty() &&
                s["values"].contains("org.c3de.mass_spring.panel/organ"));
  window.moveTo(window.inView(0.5, 0.5));
  window.key("f");
  window.key("s");
  C3DE_WAIT(window, "the tool is active", s["tool"] == "org.c3de.mass_spring.pinch");
  window.key("space");
  C3DE_WAIT(window, "it plays", s["transport"]["mode"] == "playing");
  CHECK(pull(window.state()) == 0.0);
  window.screenshot("before");

  const Json camera = window.state()["camera"];
  const Point from = window.inView(0.55, 0.5), to = window.inView(0.68, 0.3);
  window.moveTo(from);
  window.press();
  window.moveAlong(from, to, 8);
  C3DE_WAIT(window, "the hand pulls", pull(s) > 0.01);
  window.screenshot("pulling");
  window.release();
  C3DE_WAIT(window, "it is let go", pull(s) == 0.0);
  CHECK(window.state()["camera"] == camera);
  CHECK(window.state()["notifications"].empty());

  // Its state is saved to a file, advanced, and restored.
  const fs::path file = outputFile("springs.c3dstate");
  fs::remove(file);
  const auto choose = [&](const std::string &entry, const fs::path &path, std::size_t answers) {
    window.click("menu/simulation");
    C3DE_WAIT(window, "the menu is open", s["widgets"].contains("menu/" + entry));
    window.click("menu/" + entry);
    window.enterFile(path);
    return C3DE_WAIT(window, "it is answered", s["notifications"].size() == answers)["notifications"];
  };
  window.key("space");
  const Json paused = C3DE_WAIT(window, "it pauses", s["transport"]["mode"] == "paused");
  CHECK(choose("simulation.save_state", file, 1).back()["title"] == "Saved");
  window.key("space");
  C3DE_WAIT(window, "it has gone on",
            s["transport"]["steps"].get<int>() > paused["transport"]["steps"].get<int>() + 50);
  window.key("space");
  C3DE_WAIT(window, "it pauses", s["transport"]["mode"] == "paused");
  CHECK(choose("simulation.load_state", file, 2).back()["title"] == "Loaded");
  CHECK(window.state()["transport"]["steps"] == paused["transport"]["steps"]);
  // An invalid state is refused, and nothing has changed.
  std::ofstream(file) << "no state";
  const Json refused = choose("simulation.load_state", file, 3).back();
  CHECK_THAT(refused["title"].get<std::string>(), Contains("could not be loaded"));
  CHECK(window.state()["transport"]["steps"] == paused["transport"]["steps"]);
}
