// SPDX-License-Identifier: Apache-2.0
// Landmarks, distances and angles in the window: placed by clicks, carried by the tissue, undone, saved.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// A bar of 1 m with two landmarks, of which one has a target, and their distance.
fs::path measuredBar(const std::string &scenario) {
  return stretchedBar(scenario, 1.0, 1e4,
                      "[[landmark]]\nname = \"a\"\nat = [0.313, 0.071, 0.123]\n"
                      "[[landmark]]\nname = \"b\"\nat = [0.777, 0.071, 0.123]\ntarget = [0.79, 0.071, 0.123]\n"
                      "[[distance]]\nname = \"length\"\nbetween = [\"a\", \"b\"]\n");
}

const std::string kList = "measurements/";

bool isNear(double value, double wanted, double within) { return std::abs(value - wanted) <= within; }

}  // namespace

TEST_CASE("measurements of a scene follow the tissue, and one placed by a click at present is found at rest",
          "[measurements]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("measurements");
  const fs::path session = freshFile("measurements.c3de");
  openOrgan(window, {measuredBar("measurements").string()});
  window.click("measurements/header");
  C3DE_WAIT(window, "the scene's landmarks are listed", textOf(s, kList + "count") == "3");
  C3DE_WAIT(window, "at rest there is one number", textOf(s, kList + "length.label") == "464.0 mm");
  window.screenshotAtRest("rest");
  // A quasi-static simulation pauses at load factor 1.
  window.key("space");
  C3DE_WAIT(window, "the bar is stretched",
            isNear(numberOf(s, kList + "length.now"), 1.02 * 464.0, 1e-3) && s["transport"]["mode"] == "paused");
  CHECK(window.value(kList + "length.label") == "464.0 → 473.3 mm");
  const Json moved = window.state();
  CHECK(isNear(numberOf(moved, kList + "b.error"), 13.0, 1e-3));
  CHECK(isNear(norm(vectorOf(moved, kList + "a.at") - Vec3{1.02 * 313.0, 71.0, 123.0}), 0.0, 1e-3));

  // Placed on the stretched bar: its position at rest is where the stretch came from.
  window.click("toolbar/tool.measure.landmark");
  window.clickAt(window.inView(0.55, 0.5));
  C3DE_WAIT(window, "a landmark is placed", textOf(s, kList + "count") == "4");
  C3DE_WAIT(
      window, "it has moved",
      isNear(vectorOf(s, kList + "Landmark 1.at")[0], 1.02 * vectorOf(s, kList + "Landmark 1.reference")[0], 1e-3));
  const Json placed = window.state();
  const Vec3 rest = vectorOf(placed, kList + "Landmark 1.reference");
  CHECK(rest[0] > 100.0);
  CHECK(isNear(numberOf(placed, kList + "Landmark 1.now"), 0.02 * rest[0], 1e-3));
  window.screenshotAtRest("placed");

  // The measured position of the landmark is clicked.
  CHECK(window.value(kList + "Landmark 1.target") == "none");
  window.click("measurements/set_target");
  C3DE_WAIT(window, "the next click is the target", s["tool"] == "measure.landmark");
  window.clickAt(window.inView(0.6, 0.5));
  C3DE_WAIT(window, "it has a target", textOf(s, kList + "Landmark 1.target") != "none");
  const Json targeted = window.state();
  CHECK(textOf(targeted, kList + "count") == "4");
  CHECK(vectorOf(targeted, kList + "Landmark 1.target")[0] > vectorOf(targeted, kList + "Landmark 1.at")[0] + 1.0);
  CHECK(numberOf(targeted, kList + "Landmark 1.error") > 0.0);
  window.screenshotAtRest("target");
  window.click("measurements/remove_target");
  C3DE_WAIT(window, "it has none again", textOf(s, kList + "Landmark 1.target") == "none");
  window.moveTo(window.inView(0.9, 0.1));
  window.key("ctrl+z");
  C3DE_WAIT(window, "that is undone", textOf(s, kList + "Landmark 1.target") != "none");

  // A distance by press, drag and release; Escape takes back an unfinished one.
  window.click("toolbar/tool.measure.distance");
  window.clickAt(window.inView(0.45, 0.5));
  window.key("Escape");
  window.drag(window.inView(0.45, 0.5), window.inView(0.62, 0.5), 6);
  C3DE_WAIT(window, "a distance is placed", textOf(s, kList + "count") == "7");
  window.key("ctrl+z");
  C3DE_WAIT(window, "the distance is undone", textOf(s, kList + "count") == "4");
  window.key("ctrl+y");
  C3DE_WAIT(window, "and redone", textOf(s, kList + "count") == "7");
  window.screenshotAtRest("distance");

  window.key("ctrl+s");
  window.enterFile(session);
  waitForMessage(window, "Session saved");
  C3DE_WAIT(window, "nothing is unsaved", s["title"].get<std::string>().find('*') == std::string::npos);
  // Reading positions is no change of the simulation.
  CHECK(describe(session)["changes"].empty());
  const Json saved = window.state();
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);

  WorkstationDriver again("measurements_opened");
  again.start({session.string()});
  C3DE_WAIT(again, "it is opened", s["jobs"].empty() && s["transport"]["exists"].get<bool>());
  again.click("measurements/header");
  C3DE_WAIT(again, "what was placed is back", textOf(s, kList + "count") == "7");
  for (const std::string key : {"Landmark 1.reference", "Landmark 1.target", "b.error", "Distance 1.label"})
    again.waitForValue(kList + key, textOf(saved, kList + key));
}
