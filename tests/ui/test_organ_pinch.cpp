// SPDX-License-Identifier: Apache-2.0
// An organ is pulled by the pinch tool, and let go.
#include <string>

#include "c3de/core/vec.h"
#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

/// Holds the centre of the organ and pulls it towards the upper right.
void pullCentre(WorkstationDriver &window) {
  takePinch(window);
  const Point from = window.inView(0.5, 0.5);
  holdSurfel(window, from);
  for (int i = 1; i <= 6; ++i) window.moveTo({from.x + 18.0 * i, from.y - 16.0 * i});
  C3DE_WAIT(window, "the hand pulls", numberOf(s, kPanel + "Pinch force") > 0.2);
}

}  // namespace

TEST_CASE("a pinched organ follows the hand and lets go on release", "[organ_pinch]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_pinch");
  startOrgan(window);
  takePinch(window);
  play(window);
  CHECK(row(window.state(), "Pinch force") == "–");

  const Json camera = window.state()["camera"];
  const Point from = window.inView(0.5, 0.5), to = window.inView(0.62, 0.38);
  const Json held = holdSurfel(window, from);
  const auto start = vectorOf(held, kPanel + "Held point");
  window.moveAlong(from, to, 8);
  C3DE_WAIT(window, "the hand pulls", numberOf(s, kPanel + "Pinch force") > 0.0);
  window.screenshot("pulling");
  const auto hand = vectorOf(window.state(), kPanel + "Hand");
  REQUIRE(norm(hand - start) > 10.0);
  window.waitUntil("the organ follows", [&](const Json &s) {
    const auto at = vectorOf(s, kPanel + "Held point");
    return norm(at - start) > 0.3 * norm(hand - start) && norm(at - hand) < norm(start - hand);
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
  takePinch(window);
  const Point from = window.inView(0.5, 0.5), to = window.inView(0.62, 0.38);
  window.moveTo(from);
  C3DE_WAIT(window, "the status bar says it",
            s["values"].value("status/hint", "").starts_with("Space plays the simulation"));
  window.press();
  const Json held =
      C3DE_WAIT(window, "it is said at the hand", row(s, "Nothing moves") == "Stopped: press Space to play");
  CHECK(mode(held) == "stopped");
  const auto start = vectorOf(held, kPanel + "Held point");
  window.moveAlong(from, to, 4);
  window.waitFrames(5);
  window.screenshot("stopped");
  CHECK(window.state()["transport"]["steps"] == 0);

  // The hold is retained, and acts.
  window.key("space");
  C3DE_WAIT(window, "the organ follows",
            mode(s) == "playing" && row(s, "Nothing moves").empty() &&
                norm(vectorOf(s, kPanel + "Held point") - start) > 5.0);
  window.key("space");
  C3DE_WAIT(window, "a pause is said as well", row(s, "Nothing moves") == "Paused: press Space to play");
  window.screenshot("paused");
  window.release();
  C3DE_WAIT(window, "it is released", row(s, "Held point").empty());
  CHECK(window.state()["notifications"].empty());
}

TEST_CASE("a pull is undone by one step, back to the state before it, and done again", "[organ_undo_pull]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_undo_pull");
  startOrgan(window);
  play(window);
  pullCentre(window);
  window.waitFrames(30);
  window.release();
  window.moveTo(window.inView(0.9, 0.9));
  const Json paused = pause(window);
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
  CHECK(window.differsFrom("pulled", "undone", 300));
  window.key("ctrl+y");
  C3DE_WAIT(window, "the pull is done again", steps(s) == steps(paused) && row(s, "State hash") == pulled);

  // Undo during a pull releases the grab, and undoes that pull.
  window.key("space");
  C3DE_WAIT(window, "it plays on", mode(s) == "playing" && steps(s) > steps(paused) + 5);
  pullCentre(window);
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
  play(window);
  const auto isReleased = [](const Json &s) { return row(s, "Held surfel").empty() && row(s, "Pinch force") == "–"; };
  pullCentre(window);
  window.key("ctrl+r");
  window.waitUntil("the grip is gone with the state", isReleased);
  // The mouse moves on, and holds nothing.
  window.moveTo(window.inView(0.3, 0.3));
  const Json after = window.state();
  CHECK(isReleased(after));
  window.release();
  // The next one holds again.
  pullCentre(window);
  pause(window);
  window.key("ctrl+r");
  window.waitUntil("also while it stands", isReleased);
  window.screenshot("let_go");
  window.release();
}
