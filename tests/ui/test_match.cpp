// SPDX-License-Identifier: Apache-2.0
// A body is matched to measurements from the menu: table, points in the 3D view, cancel, refusals, undo, sessions.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "support/folders.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

fs::path resource(const char *name) { return fs::path(testResourcesFolder()) / name; }
fs::path organPoints() { return resource("match/organ_points.csv"); }

const std::string kMatch = "match/";

bool hasNode(const Json &state, const std::string &name) {
  for (const Json &one : state["nodes"])
    if (one["name"] == name) return true;
  return false;
}

void closeMessages(WorkstationDriver &window) {
  for (std::size_t n = window.state()["notifications"].size(); n > 0; n = window.state()["notifications"].size()) {
    window.click("notification/close.0");
    C3DE_WAIT(window, "a message is closed", s["notifications"].size() < n);
  }
}

void loadLandmarks(WorkstationDriver &window) {
  window.click("measurements/header");
  window.click("measurements/load");
  window.openFile(resource("match/organ_landmarks.csv"));
  C3DE_WAIT(window, "the landmarks are listed", textOf(s, "measurements/count") == "3");
  window.click("measurements/header");
  closeMessages(window);
}

void choosePoints(WorkstationDriver &window, const fs::path &file) {
  window.click("match/points");
  window.openFile(file);
  C3DE_WAIT(window, "the file is chosen", textOf(s, "match/points").ends_with(file.filename().string()));
}

/// Waits for the result; returns its state.
Json matched(WorkstationDriver &window, const std::string &verdict) {
  window.click("match/match");
  return C3DE_WAIT(window, "it is matched", s["jobs"].empty() && textOf(s, kMatch + "Verdict") == verdict);
}

fs::path pointFile(const std::string &name, const std::string &rows) {
  fs::path file = outputFile(name);
  std::ofstream(file) << rows;
  return file;
}

/// The points of the organ, multiplied; only the first ones.
fs::path scaledPoints(const std::string &name, double factor, int count) {
  std::ifstream in(organPoints());
  std::string rows, row;
  for (int n = 0; n < count && std::getline(in, row);) {
    double x = 0.0, y = 0.0, z = 0.0;
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &x, &y, &z) != 3) continue;
    rows += std::to_string(factor * x) + "," + std::to_string(factor * y) + "," + std::to_string(factor * z) + "\n";
    ++n;
  }
  return pointFile(name, rows);
}

/// A finer organ, whose match takes some seconds.
fs::path fineOrgan() {
  fs::path scene = outputFile("match_fine.toml");
  std::ofstream(scene) << "format = 1\ntitle = \"Fine organ\"\n[world]\ngravity = [0.0, 0.0, 0.0]\n[[body]]\n"
                          "name = \"organ\"\nmesh = \""
                       << organMesh().generic_string()
                       << "\"\nmesh_unit = \"mm\"\nposition = [0.028, 0.16, 0.0]\n"
                          "material = { law = \"linear\", youngs_modulus = 6e3, poisson_ratio = 0.45, density = 1060.0 "
                          "}\nsampling = { count = 6000 }\n";
  return scene;
}

}  // namespace

TEST_CASE("the organ is matched to points from the menu, undone, saved and opened again", "[match]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path session = freshFile("match.c3de"), residuals = freshFile("match-residuals.csv");
  WorkstationDriver window("match");
  openOrgan(window, {resource("scenes/first_light.toml").string()});
  loadLandmarks(window);
  window.screenshotAtRest("before");
  window.clickMenu("simulation.match");
  // The panel is in view, although that of the simulation is long.
  C3DE_WAIT(window, "the panel is in view", s["widgets"].contains("match/points"));
  CHECK(window.value("match/Body") == "organ");
  choosePoints(window, organPoints());
  window.click("match/landmarks");
  window.openFile(resource("match/organ_landmarks_measured.csv"));
  const Json result = matched(window, "found");
  CHECK(std::abs(numberOf(result, kMatch + "Points, rigid") - 1.0) < 0.25);
  CHECK(numberOf(result, kMatch + "Points, at rest") > 20.0);
  CHECK(numberOf(result, kMatch + "Points, deformed") < 1.25);
  CHECK(numberOf(result, kMatch + "Landmarks, at rest") > 100.0);
  CHECK(numberOf(result, kMatch + "Landmarks, rigid") < 6.0);
  CHECK(numberOf(result, kMatch + "Landmarks, deformed") < 8.0);
  CHECK_THAT(textOf(result, kMatch + "rim"), Contains(" → "));
  CHECK_THAT(textOf(result, kMatch + "Expected error"), Contains("mm rms"));
  CHECK(notification(result, "Match of organ: found") != nullptr);
  CHECK(
      (hasNode(result, "measured points") && hasNode(result, "residuals") && hasNode(result, "targets of landmarks")));
  closeMessages(window);
  window.screenshotAtRest("matched");
  CHECK(window.differsFrom("before", "matched", 2000));
  window.enterNumber("match/arrows", "10");
  (void)window.locate("match/points");
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshotAtRest("arrows");
  CHECK(window.differsFrom("matched", "arrows", 300));
  window.click("scene/measured points");
  C3DE_WAIT(window, "the points are hidden", [&] {
    for (const Json &one : s["nodes"])
      if (one["name"] == "measured points") return !one["visible"].get<bool>();
    return false;
  }());
  window.screenshotAtRest("hidden");
  CHECK(window.differsFrom("arrows", "hidden", 500));

  // The expected error on the skin is hidden at first.
  window.click("scene/expected error");
  window.screenshotAtRest("expected");
  CHECK(window.differsFrom("hidden", "expected", 5000));

  window.clickMenu("file.export_residuals");
  window.enterFile(residuals);
  waitForMessage(window, "Exported");
  std::ifstream rows(residuals);
  std::string row;
  std::size_t count = 0;
  while (std::getline(rows, row)) ++count;
  CHECK(count == 501);
  closeMessages(window);

  const auto rim = [](const Json &s) { return vectorOf(s, "measurements/rim.at"); };
  window.click("measurements/header");
  C3DE_WAIT(window, "the landmark has moved", numberOf(s, "measurements/rim.now") > 0.05);
  const Vec3 moved = rim(window.state());
  window.key("ctrl+z");
  waitForMessage(window, "Undo match organ");
  C3DE_WAIT(window, "it is at rest",
            !s["values"].contains(kMatch + "Verdict") && !hasNode(s, "measured points") &&
                norm(rim(s) - Vec3{120, 160, 0}) < 1e-3);
  window.key("ctrl+y");
  waitForMessage(window, "Redo match organ");
  C3DE_WAIT(window, "it is matched again", norm(rim(s) - moved) < 1e-4);

  window.enterNumber("match/noise", "2");
  window.key("ctrl+s");
  window.enterFile(session);
  waitForMessage(window, "Session saved");
  C3DE_WAIT(window, "nothing is unsaved",
            s["title"].get<std::string>().find('*') == std::string::npos && s["jobs"].empty());
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);

  WorkstationDriver again("match_opened");
  again.start({session.string()});
  C3DE_WAIT(again, "it is opened", s["jobs"].empty() && s["transport"]["exists"].get<bool>());
  again.click("measurements/header");
  C3DE_WAIT(again, "it has the matched shape", norm(rim(s) - moved) < 1e-4);
  // The panel has the files and values again, and the same match is possible.
  again.clickMenu("simulation.match");
  C3DE_WAIT(again, "the panel is filled", textOf(s, "match/points").ends_with("organ_points.csv"));
  CHECK_THAT(again.value("match/landmarks"), Contains("organ_landmarks_measured.csv"));
  CHECK(again.value("match/noise") == "2 mm");
  again.screenshotAtRest("restored");
  again.click("match/close");
  // It can be pulled on as any body.
  again.moveTo(again.inView(0.5, 0.5));
  again.key("f");
  play(again);
  CHECK(mode(pause(again)) == "paused");
}

TEST_CASE("a match is cancelled, and the body stays as it was", "[match_cancel]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("match_cancel");
  openOrgan(window, {fineOrgan().string()});
  window.key("ctrl+shift+m");
  C3DE_WAIT(window, "the panel is open", s["widgets"].contains("match/points"));
  choosePoints(window, organPoints());
  const std::string before = row(window.state(), "State hash");
  window.screenshotAtRest("before");
  window.click("match/match");
  C3DE_WAIT(window, "it runs", s["widgets"].contains("match/cancel") && !s["jobs"].empty());
  C3DE_WAIT(window, "points and body follow",
            !s["jobs"].empty() && hasNode(s, "measured points") && row(s, "State hash") != before);
  window.click("match/cancel");
  waitForMessage(window, "Match cancelled: organ");
  C3DE_WAIT(window, "it can begin again", s["jobs"].empty() && s["widgets"].contains("match/match"));
  CHECK_FALSE(window.state()["values"].contains(kMatch + "Verdict"));
  CHECK_FALSE(hasNode(window.state(), "measured points"));
  C3DE_WAIT(window, "the body has its state from before", row(s, "State hash") == before);
  window.moveTo(window.inView(0.9, 0.9));
  window.screenshotAtRest("cancelled");
  CHECK(window.differingPixels("before", "cancelled") < 300);
  // Only the values of the panel have changed.
  window.key("ctrl+q");
  const Json asked = C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
  CHECK(textOf(asked, "quit/text") == "The values of the panel Match are not saved.");
}

TEST_CASE("what cannot be matched leads to a message, and the body stays", "[match_bad]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("match_bad");
  startOrgan(window);
  window.clickMenu("simulation.match");
  C3DE_WAIT(window, "the panel is open", s["widgets"].contains("match/points"));
  const auto isDisabled = [&](const std::string &widget) {
    const Json state = window.state();
    return std::find(state["disabled"].begin(), state["disabled"].end(), widget) != state["disabled"].end();
  };
  CHECK(isDisabled("match/match"));
  const auto refused = [&](const fs::path &file, const std::string &why) {
    CAPTURE(why);
    choosePoints(window, file);
    window.click("match/match");
    waitForMessage(window, why);
    CHECK(notification(window.state(), "The body was not matched") != nullptr);
    closeMessages(window);
    CHECK_FALSE(window.state()["values"].contains(kMatch + "Verdict"));
  };
  refused(pointFile("match_nan.csv", "x,y,z\n1,2,3\n4,nan,6\n"), "match_nan.csv:3: y is 'nan'");
  refused(scaledPoints("match_metres.csv", 1e-3, 500), "match_metres.csv");
  refused(scaledPoints("match_few.csv", 1.0, 7), "7");
  // Landmarks that do not exist cannot be fitted.
  choosePoints(window, organPoints());
  window.choose("match/use", "are fitted");
  window.click("match/match");
  waitForMessage(window, "no landmark has a measured position");
  closeMessages(window);
  window.choose("match/use", "judge the result");
  // With the unit it is read.
  choosePoints(window, outputFile("match_metres.csv"));
  window.choose("match/unit", "m");
  window.click("match/deform");
  const Json result = matched(window, "found");
  CHECK(std::abs(numberOf(result, kMatch + "Points, rigid") - 1.0) < 0.25);
  CHECK_FALSE(result["values"].contains(kMatch + "Points, deformed"));
  // Neither motion nor deformation: nothing to find.
  window.click("match/rigid");
  C3DE_WAIT(window, "it is disabled",
            std::find(s["disabled"].begin(), s["disabled"].end(), "match/match") != s["disabled"].end());
  window.click("match/close");
  C3DE_WAIT(window, "the panel is closed", !s["widgets"].contains("match/close") && !hasNode(s, "measured points"));
}

TEST_CASE("several motions that fit equally well are listed, shown, and chosen", "[match_ambiguous]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("match_ambiguous");
  openOrgan(window, {stretchedBar("match_ambiguous", 0.2, 1e4, "").string()});
  window.clickMenu("simulation.match");
  C3DE_WAIT(window, "the panel is open", s["widgets"].contains("match/source"));
  window.choose("match/source", "surface");
  window.click("match/surface");
  window.openFile(outputFile("match_ambiguous.obj"));
  window.choose("match/unit", "m");
  const Json result = matched(window, "ambiguous");
  REQUIRE((result["widgets"].contains("match/candidate.1.show") ||
           result["scrolled_out"].contains("match/candidate.1.show")));
  CHECK(notification(result, "Match of box: ambiguous") != nullptr);
  CHECK_FALSE(result["values"].contains(kMatch + "Points, deformed"));
  closeMessages(window);
  window.screenshotAtRest("first");
  window.click("match/candidate.1.show");
  C3DE_WAIT(window, "the other one is shown",
            std::find(s["disabled"].begin(), s["disabled"].end(), "match/candidate.1.show") != s["disabled"].end());
  window.click("match/candidate.1.deform");
  C3DE_WAIT(window, "it is deformed from there",
            s["jobs"].empty() && textOf(s, kMatch + "Motion") == "candidate 2, chosen by you");
  CHECK(window.value(kMatch + "Verdict") == "ambiguous");
  window.screenshotAtRest("chosen");
}
