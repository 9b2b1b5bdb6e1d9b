// SPDX-License-Identifier: Apache-2.0
// A recording is opened in the window and scrubbed through with the mouse.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "c3de/render/png_file.h"
#include "support/catch.h"
#include "ui/program_command.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

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

/// The floating organ with a probe.
fs::path probedOrgan() {
  std::ifstream in(floatingOrgan());
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const fs::path scene = outputFile("probed.toml");
  std::ofstream(scene) << text << "[[probe]]\nname = \"middle\"\nbody = \"organ\"\nat = [0.0, 0.0, 0.0]\n";
  return scene;
}

/// Records a pull, and a value that is set after it.
void recordPull(WorkstationDriver &window, const fs::path &file, bool isStopped) {
  window.clickMenu("simulation.start_recording");
  window.enterFile(file);
  C3DE_WAIT(window, "it records", textOf(s, "status/recording") == "Recording");
  playAndPull(window);
  window.enterNumber(kPanel + "material.youngs_modulus", "9000 Pa");
  const int before = window.state()["transport"]["steps"];
  C3DE_WAIT(window, "it continues", s["transport"]["steps"].get<int>() > before + 250);
  if (!isStopped) return;
  pause(window);
  window.clickMenu("simulation.stop_recording");
  waitForMessage(window, "Recording saved");
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
  const auto described = runProcess(programCommand({"info", session.string(), "--json"}), 60.0);
  REQUIRE(described);
  INFO(described->errorOutput);
  REQUIRE(described->exitCode == 0);
  return Json::parse(described->output)["state_hash"];
}

bool isDisabled(const Json &s, const std::string &widget) {
  return std::count(s["disabled"].begin(), s["disabled"].end(), Json(widget)) > 0;
}

std::string bytesOf(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t filesIn(const fs::path &folder, const std::string &extension) {
  std::error_code ignored;
  std::size_t count = 0;
  for (const auto &entry : fs::directory_iterator(folder, ignored)) count += entry.path().extension() == extension;
  return count;
}

/// Writes into a field of the dialog that exports.
void enterText(WorkstationDriver &window, const std::string &field, const std::string &text) {
  window.click(field);
  window.key("ctrl+a");
  window.type(text);
  C3DE_WAIT(window, field + " is " + text, textOf(s, field) == text);
}

/// Moves the timeline, and waits until it is there.
void jumpTo(WorkstationDriver &window, double share) {
  window.clickAt(onSlider(window, share));
  const double length = window.number("timeline/length");
  C3DE_WAIT(window, "the position is reached",
            isAtRest(s) && std::abs(numberOf(s, "timeline/position") - share * length) < 0.01 * length + 1.0);
}

bool isExporting(const Json &s) { return !textOf(s, "timeline/exporting").empty(); }

}  // namespace

TEST_CASE("a recording is scrubbed with the mouse, and continued from a moment of it", "[timeline]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = freshFile("timeline.c3dr"), session = freshFile("timeline_from.c3de"),
                 straight = freshFile("timeline_straight.c3de");
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
  waitForModulus(window, "9 kPa");
  window.screenshot("late");
  scrub(window, 0.95, 0.1);
  waitForModulus(window, "6 kPa");
  window.screenshot("early");
  const Json late = scrub(window, 0.1, 0.9);
  waitForModulus(window, "9 kPa");
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
  waitForMessage(window, "The replay ended");
  const Json left = C3DE_WAIT(window, "it is an ordinary simulation", !s["values"].contains("timeline/position"));
  CHECK(left["title"] == "Floating organ* - C3DE");
  window.key("ctrl+s");
  window.enterFile(session);
  waitForMessage(window, "Session saved");
  const auto replayed = runProcess(programCommand({"replay", file.string(), "--check", "--until",
                                                   fmt::format("{}", time_s), "--save-session", straight.string()}),
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
  const fs::path file = freshFile("past.c3dr"), session = freshFile("past_now.c3de"),
                 straight = freshFile("past_straight.c3de");
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
  waitForMessage(window, "Session saved");
  const auto replayed =
      runProcess(programCommand({"replay", file.string(), "--check", "--save-session", straight.string()}), 120.0);
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

TEST_CASE("a stretch of a recording is exported as pictures and for ParaView", "[timeline_export]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = freshFile("export.c3dr"), folder = outputFile("exported"), straight = outputFile("straight");
  fs::remove_all(folder);
  fs::remove_all(straight);
  fs::create_directories(folder);
  fs::create_directories(straight);
  WorkstationDriver window("timeline_export");
  openOrgan(window, {probedOrgan().string()});
  recordPull(window, file, true);
  window.clickMenu("file.open_recording");
  window.enterFile(file);
  const Json opened = C3DE_WAIT(window, "the timeline is shown", isAtRest(s) && textOf(s, "timeline/position") == "0");
  const int length = static_cast<int>(numberOf(opened, "timeline/length"));
  CHECK(textOf(opened, "timeline/stretch") == "0 " + std::to_string(length));
  CHECK(isDisabled(opened, "timeline/until"));

  // The markers.
  jumpTo(window, 0.05);
  window.click("timeline/begin");
  const int begin = static_cast<int>(window.number("timeline/position"));
  const Json atBegin = window.state()["transport"];
  const double step_s = atBegin["time_s"].get<double>() / atBegin["steps"].get<double>();
  jumpTo(window, 0.6);
  window.click("timeline/until");
  const int end = static_cast<int>(window.number("timeline/position"));
  C3DE_WAIT(window, "the markers are set",
            textOf(s, "timeline/stretch") == std::to_string(begin) + " " + std::to_string(end));
  jumpTo(window, 0.8);
  const double before = window.number("timeline/position");

  // What is wrong is stated.
  window.click("timeline/export");
  C3DE_WAIT(window, "the dialog is shown", s["widgets"].contains("stretch/export"));
  window.click("stretch/probes");
  enterText(window, "stretch/folder", nameInProgram(folder / "missing"));
  window.click("stretch/export");
  C3DE_WAIT(window, "the folder is refused", textOf(s, "stretch/answer").find("missing") != std::string::npos);
  enterText(window, "stretch/folder", nameInProgram(folder));
  enterText(window, "stretch/name", "pull");
  window.click("stretch/pictures");
  enterText(window, "stretch/width", "320");
  enterText(window, "stretch/height", "240");
  const bool canFilm = !isDisabled(window.state(), "stretch/film");
  if (canFilm) window.click("stretch/film");
  window.screenshot("dialog");

  window.click("stretch/export");
  C3DE_WAIT(window, "it is exporting",
            isExporting(s) || s["notifications"].dump().find("Exported") != std::string::npos);
  window.screenshot("exporting");
  const Json done = C3DE_WAIT(window, "the timeline is where it was before",
                              !isExporting(s) && isAtRest(s) && numberOf(s, "timeline/position") == before &&
                                  s["notifications"].dump().find("Exported") != std::string::npos);
  CHECK(textOf(done, "timeline/warning").empty());
  window.screenshot("exported");

  // One per 40 ms of simulated time, and at the begin.
  const auto count = static_cast<std::size_t>(std::floor((end - begin) * step_s / 0.04 + 1e-6)) + 1;
  CHECK(count > 5);
  const fs::path pictures = folder / "pull_pictures", frames = folder / "pull_frames";
  CHECK(filesIn(pictures, ".png") == count);
  CHECK(filesIn(frames, ".vtp") == count);
  CHECK(filesIn(frames, ".vtu") == count);
  const auto first = render::readPng(pictures / "picture_000000.png");
  const auto last = render::readPng(pictures / ("picture_" + std::to_string(1000000 + count - 1).substr(1) + ".png"));
  REQUIRE(first);
  REQUIRE(last);
  CHECK((first->width == 320 && first->height == 240));
  CHECK((first->rgb != last->rgb));  // without the bytes of both in the message
  const std::string table = bytesOf(folder / "pull.csv");
  CHECK(table.find("time [s],middle.x [m],") == 0);
  CHECK(std::count(table.begin(), table.end(), '\n') == end - begin + 2);
  if (canFilm) {
    C3DE_WAIT(window, "the film is made", fs::exists(folder / "pull.mp4"));
    CHECK(bytesOf(folder / "pull.mp4").find("ftyp") != std::string::npos);
  }

  // Each frame is that of the command line at the last step not after its time. There, each step is a frame.
  const auto seconds = [&](double steps) { return std::to_string(steps * step_s); };
  const auto replayed =
      runProcess(programCommand({"replay", file.string(), "--export", (straight / "pull.pvd").string(), "--from",
                                 seconds(begin - 0.5), "--export-every", std::to_string(0.01 * step_s), "--until",
                                 seconds(begin + 150)}),
                 120.0);
  REQUIRE(replayed);
  INFO(replayed->errorOutput << replayed->output);
  REQUIRE(replayed->exitCode == 0);
  const auto sixDigits = [](int number) { return std::to_string(1000000 + number).substr(1); };
  for (const int k : {0, 3, 7, 10}) {
    const int step = static_cast<int>(std::floor(k * 0.04 / step_s + 1e-6));
    const std::string skin = bytesOf(frames / ("skin_" + sixDigits(k) + ".vtp"));
    CHECK_FALSE(skin.empty());
    CHECK((skin == bytesOf(straight / "pull_frames" / ("skin_" + sixDigits(step) + ".vtp"))));
  }

  // Files are replaced after a question only; a cancelled export leaves what it has written.
  window.click("timeline/export");
  C3DE_WAIT(window, "the dialog is shown", s["widgets"].contains("stretch/export"));
  window.click("stretch/frames");
  window.click("stretch/probes");
  if (canFilm) window.click("stretch/film");
  enterText(window, "stretch/rate", "1000");
  window.click("stretch/export");
  C3DE_WAIT(window, "it asks", textOf(s, "stretch/answer").find("pull_pictures already exists") != std::string::npos);
  window.screenshot("asks");
  window.click("stretch/export");
  C3DE_WAIT(window, "it is exporting", isExporting(s) && filesIn(pictures, ".png") > count);
  window.click("timeline/cancel");
  C3DE_WAIT(window, "it is cancelled, and the timeline is where it was before",
            !isExporting(s) && isAtRest(s) && numberOf(s, "timeline/position") == before &&
                s["notifications"].dump().find("Export cancelled") != std::string::npos);
  CHECK(filesIn(pictures, ".png") < static_cast<std::size_t>((end - begin) * step_s * 1000.0));
}
