// SPDX-License-Identifier: Apache-2.0
// Plugins that act on an organ of the point-based plugin, and their commands.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace fs = std::filesystem;

TEST_CASE("a plugin's force field pulls an organ of the point-based plugin, live by its parameter", "[organ_magnet]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string magnet = examplePlugin("magnet");
  if (!fs::exists(magnet)) C3DE_SKIP("the magnet is not built");
  constexpr const char *kStrength = "org.c3de.magnet.panel/strength", *kPulls = "org.c3de.magnet.panel/Pulls with";
  WorkstationDriver window("organ_magnet");
  startOrgan(window, {"--plugin", magnet});
  CHECK(window.value(kPulls) == "0 N on 0 points");
  window.screenshot("before");

  // One step, so that the first force acts on the undeformed organ however slow the machine is.
  const Point at = window.locate(kStrength);
  window.drag(at, {at.x + 40, at.y}, 4);
  window.moveTo(window.inView(0.9, 0.1));
  window.key("Right");
  const auto force = [&](const Json &s) { return std::strtod(s["values"].value(kPulls, "0").c_str(), nullptr); };
  const Json pulled = C3DE_WAIT(window, "it pulls", force(s) > 0.0 && mode(s) == "paused");
  play(window);
  const std::string hash = row(pulled, "State hash");
  C3DE_WAIT(window, "the organ follows", row(s, "State hash") != hash);
  const double near =
      force(C3DE_WAIT(window, "it comes nearer, so that it is pulled harder", force(s) > 1.2 * force(pulled)));
  CHECK(near > 0.0);
  window.screenshot("after");
  CHECK(window.differsFrom("before", "after", 500));

  window.key("ctrl+z");
  C3DE_WAIT(window, "without the force it is off", force(s) == 0.0);
  CHECK(window.state()["messages"].empty());
}

TEST_CASE("a plugin's clamp and the pinch hold one organ, each lets go by itself", "[organ_clamp]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string clamp = examplePlugin("clamp");
  if (!fs::exists(clamp)) C3DE_SKIP("the clamp is not built");
  constexpr const char *kClosed = "org.c3de.clamp.panel/closed", *kTurn = "org.c3de.clamp.panel/turn",
                       *kPulls = "org.c3de.clamp.panel/Pulls with", *kTurns = "org.c3de.clamp.panel/Turns with";
  WorkstationDriver window("organ_clamp");
  startOrgan(window, {"--plugin", clamp});
  play(window);
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

TEST_CASE("a command of a plugin stands in the menu and answers its keys, where it fails its text is shown",
          "[commands]") {
  C3DE_ORGAN_OR_SKIP();
  const std::string samples = examplePlugin("image_samples");
  if (!fs::exists(samples)) C3DE_SKIP("image_samples is not built");
  constexpr const char *kEntry = "menu/plugins.org.c3de.image_samples.log";
  WorkstationDriver window("commands");
  startOrgan(window, {"--plugin", samples});
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
