// SPDX-License-Identifier: Apache-2.0
// A recording is opened in the window and scrubbed through with the mouse.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

fs::path emptyPlace(const std::string &name) {
  const fs::path file = outputFile(name);
  fs::remove(file);
  return file;
}

void waitForText(WorkstationDriver &window, const std::string &wanted) {
  C3DE_WAIT(window, wanted, s["notifications"].dump().find(wanted) != std::string::npos);
}

/// The floating organ with implicit steps.
fs::path implicitOrgan() {
  std::ifstream in(floatingOrgan());
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string table = "[solver]\n";
  text.insert(text.find(table) + table.size(), "integrator = \"implicit\"\n");
  const fs::path scene = outputFile("implicit.toml");
  std::ofstream(scene) << text;
  return scene;
}

/// Records a pull, and a value that is set after it.
void recordPull(WorkstationDriver &window, const fs::path &file, bool isStopped) {
  window.clickMenu("simulation.start_recording");
  window.enterFile(file);
  C3DE_WAIT(window, "it records", textOf(s, "status/recording") == "Recording");
  takePinch(window);
  play(window);
  pull(window, window.inView(0.5, 0.5), window.inView(0.65, 0.4));
  const int pulled = window.state()["transport"]["steps"];
  C3DE_WAIT(window, "the pull lasts", s["transport"]["steps"].get<int>() > pulled + 150);
  window.release();
  window.enterNumber(kPanel + "material.youngs_modulus", "9000");
  const int before = window.state()["transport"]["steps"];
  C3DE_WAIT(window, "it continues", s["transport"]["steps"].get<int>() > before + 250);
  if (!isStopped) return;
  pause(window);
  window.clickMenu("simulation.stop_recording");
  waitForText(window, "Recording saved");
}

bool isAtRest(const Json &s) { return textOf(s, "timeline/state") == "paused" && s["jobs"].empty(); }

/// A point of the slider.
Point onSlider(WorkstationDriver &window, double share) {
  const Json rect = window.state()["widgets"]["timeline/slider"];
  const double inset = 8.0, x0 = rect[0].get<double>() + inset, x1 = rect[2].get<double>() - inset;
  return {std::round(x0 + share * (x1 - x0)), 0.5 * (rect[1].get<double>() + rect[3].get<double>())};
}

/// Drags the thumb; returns the state when the position is reached.
Json scrub(WorkstationDriver &window, double from, double to) {
  window.drag(onSlider(window, from), onSlider(window, to), 6);
  const double length = window.number("timeline/length");
  return C3DE_WAIT(window, "the position is reached",
                   isAtRest(s) && std::abs(numberOf(s, "timeline/position") - to * length) < 0.01 * length + 1.0);
}

/// The position of a change in the list of marks; below 0: there is none.
double markOf(const std::string &marks, const std::string &text) {
  std::istringstream lines(marks);
  for (std::string line; std::getline(lines, line);)
    if (line.find(text) != std::string::npos) return std::stod(line);
  return -1.0;
}

void waitForModulus(WorkstationDriver &window, const std::string &text) {
  C3DE_WAIT(window, text + " is shown", row(s, "material.youngs_modulus") == text);
}

/// The state hash of a session.
std::string hashOf(const fs::path &session) {
  const auto described = runProcess({C3DE_PROGRAM, "info", session.string(), "--json"}, 60.0);
  REQUIRE(described);
  INFO(described->errorOutput);
  REQUIRE(described->exitCode == 0);
  return Json::parse(described->output)["state_hash"];
}

bool isDisabled(const Json &s, const std::string &widget) {
  return std::count(s["disabled"].begin(), s["disabled"].end(), Json(widget)) > 0;
}

}  // namespace

TEST_CASE("a recording is scrubbed with the mouse, and continued from a moment of it", "[timeline]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = emptyPlace("timeline.c3dr"), session = emptyPlace("timeline_from.c3de"),
                 straight = emptyPlace("timeline_straight.c3de");
  WorkstationDriver window("timeline");
  startOrgan(window);
  recordPull(window, file, true);

  window.clickMenu("file.open_recording");
  window.enterFile(file);
  const Json opened = C3DE_WAIT(window, "the timeline is shown", isAtRest(s) && textOf(s, "timeline/position") == "0");
  CHECK(opened["title"] == "timeline.c3dr - C3DE");
  CHECK(isDisabled(opened, "toolbar/tool.pointbased.pinch"));
  CHECK(opened["tool"] == "orbit");
  const double length = numberOf(opened, "timeline/length");
  CHECK(length > 400);
  window.screenshot("opened");
  window.key("p");

  // Forward beyond the change of a parameter, back before it, and forth again.
  scrub(window, 0.0, 0.95);
  CHECK(window.state()["tool"] == "orbit");
  waitForModulus(window, "9000 Pa");
  window.screenshot("late");
  scrub(window, 0.95, 0.1);
  waitForModulus(window, "6000 Pa");
  window.screenshot("early");
  const Json late = scrub(window, 0.1, 0.9);
  waitForModulus(window, "9000 Pa");
  CHECK(textOf(late, "timeline/warning").empty());

  // Its buttons.
  window.click("timeline/end");
  const Json end = C3DE_WAIT(window, "the end is reached", isAtRest(s) && numberOf(s, "timeline/position") == length);
  CHECK(textOf(end, "timeline/warning").empty());
  CHECK(isDisabled(end, "timeline/play"));
  window.click("timeline/start");
  C3DE_WAIT(window, "the start is reached", isAtRest(s) && numberOf(s, "timeline/position") == 0);
  window.click("timeline/step");
  C3DE_WAIT(window, "a step is made", isAtRest(s) && numberOf(s, "timeline/position") == 1);
  window.click("timeline/play");
  C3DE_WAIT(window, "it plays in real time", numberOf(s, "timeline/position") > 10);
  window.click("timeline/play");
  C3DE_WAIT(window, "it pauses", isAtRest(s));
  window.choose("timeline/rate", "max");
  window.click("timeline/play");
  C3DE_WAIT(window, "it plays", numberOf(s, "timeline/position") > 50);
  window.click("timeline/play");
  C3DE_WAIT(window, "it pauses", isAtRest(s));
  scrub(window, window.number("timeline/position") / length, 0.92);
  const double changed = markOf(window.value("timeline/marks"), "set Young's modulus of organ");
  window.moveTo(onSlider(window, changed / length));
  C3DE_WAIT(window, "the slider names the change",
            textOf(s, "timeline/hover").find("set Young's modulus of organ") != std::string::npos);
  window.screenshot("hover");

  // The state is that of a straight replay.
  const double time_s = window.state()["transport"]["time_s"];
  const int steps = window.state()["transport"]["steps"];
  window.click("timeline/continue");
  waitForText(window, "The replay ended");
  const Json left = C3DE_WAIT(window, "it is an ordinary simulation", !s["values"].contains("timeline/position"));
  CHECK(left["title"] == "Floating organ* - C3DE");
  window.key("ctrl+s");
  window.enterFile(session);
  waitForText(window, "Session saved");
  const auto replayed = runProcess({C3DE_PROGRAM, "replay", file.string(), "--check", "--until", std::to_string(time_s),
                                    "--save-session", straight.string()},
                                   120.0);
  REQUIRE(replayed);
  INFO(replayed->errorOutput << replayed->output);
  REQUIRE(replayed->exitCode == 0);
  CHECK(steps > 0);
  CHECK(hashOf(session) == hashOf(straight));

  // It can be pulled.
  takePinch(window);
  play(window);
  pull(window, window.inView(0.5, 0.5), window.inView(0.6, 0.45));
  C3DE_WAIT(window, "a surfel is held", !row(s, "Held surfel").empty());
  window.release();
  window.screenshot("continued");
}

TEST_CASE("the past of an implicit run is shown, and the present is returned to", "[timeline_past]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = emptyPlace("past.c3dr"), session = emptyPlace("past_now.c3de"),
                 straight = emptyPlace("past_straight.c3de");
  WorkstationDriver window("timeline_past");
  openOrgan(window, {implicitOrgan().string()});
  recordPull(window, file, false);
  const Json now = pause(window);
  window.clickMenu("simulation.show_timeline");
  const Json opened = C3DE_WAIT(window, "the timeline is shown", isAtRest(s) && textOf(s, "timeline/position") == "0");
  CHECK(textOf(opened, "status/recording").empty());
  const double length = numberOf(opened, "timeline/length");
  CHECK(length == now["transport"]["steps"].get<double>());

  // A wrong warm start of the solver would change the hashes.
  scrub(window, 0.0, 0.5);
  scrub(window, 0.5, 0.2);
  scrub(window, 0.2, 0.7);
  window.screenshot("past");
  window.click("timeline/end");
  const Json end = C3DE_WAIT(window, "the end is reached", isAtRest(s) && numberOf(s, "timeline/position") == length);
  CHECK(textOf(end, "timeline/warning").empty());
  window.click("timeline/start");
  C3DE_WAIT(window, "the start is reached", isAtRest(s) && numberOf(s, "timeline/position") == 0);

  window.click("timeline/now");
  const Json back =
      C3DE_WAIT(window, "it is the present simulation",
                !s["values"].contains("timeline/position") && s["transport"]["steps"] == now["transport"]["steps"]);
  CHECK(back["title"] == "Floating organ* - C3DE");
  window.screenshot("now");
  window.key("ctrl+s");
  window.enterFile(session);
  waitForText(window, "Session saved");
  const auto replayed =
      runProcess({C3DE_PROGRAM, "replay", file.string(), "--check", "--save-session", straight.string()}, 120.0);
  REQUIRE(replayed);
  INFO(replayed->errorOutput << replayed->output);
  REQUIRE(replayed->exitCode == 0);
  CHECK(hashOf(session) == hashOf(straight));

  // By its name on the command line.
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
  WorkstationDriver again("timeline_opened");
  again.start({file.string()});
  const Json shown = C3DE_WAIT(again, "the timeline is shown", isAtRest(s) && textOf(s, "timeline/position") == "0");
  CHECK(shown["notifications"].empty());
  CHECK(shown["title"] == "past.c3dr - C3DE");
}
