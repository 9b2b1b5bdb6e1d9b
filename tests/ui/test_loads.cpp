// SPDX-License-Identifier: Apache-2.0
// Supports and loads are painted on an organ, act while it plays, and are undone.
#include <string>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

TEST_CASE("a force painted on an organ acts while it plays and is undone", "[organ_loads]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_loads");
  startOrgan(window);
  const Point middle = window.inView(0.5, 0.5);
  window.moveTo(middle);
  window.key("n");
  C3DE_WAIT(window, "the load tool is active", s["tool"] == "pointbased.load");
  CHECK(row(window.state(), "Selected") == "nothing");
  window.press();
  window.moveAlong(middle, {middle.x + 25.0, middle.y}, 4);
  window.release();
  C3DE_WAIT(window, "a part of the surface is selected", row(s, "Selected").find("mm²") != std::string::npos);
  window.screenshotAtRest("selected");
  const std::string selected = row(window.state(), "Selected");

  // With E, what is painted again is removed.
  window.key("e");
  window.waitForValue(kPanel + "load_removing", "true");
  window.drag(middle, {middle.x + 25.0, middle.y}, 4);
  C3DE_WAIT(window, "less is selected", row(s, "Selected") != selected);
  window.key("e");
  window.waitForValue(kPanel + "load_removing", "false");
  window.drag(middle, {middle.x + 25.0, middle.y}, 4);
  C3DE_WAIT(window, "it is selected again", row(s, "Selected") == selected);

  window.choose(kPanel + "load_kind", "Force");
  window.click(kPanel + "load_add");
  C3DE_WAIT(window, "the force is listed", !row(s, "Force 1").empty());
  C3DE_WAIT(window, "its sum is stated", row(s, "Total force").starts_with("1.000 N"));
  window.screenshotAtRest("set");
  play(window);
  C3DE_WAIT(window, "it moves the organ", s["transport"]["steps"] > 20);
  window.screenshot("pushed");
  (void)pause(window);
  window.key("ctrl+z");
  C3DE_WAIT(window, "it is undone", row(s, "Force 1").empty());
  window.key("ctrl+y");
  C3DE_WAIT(window, "it is set again", !row(s, "Force 1").empty());
  window.click(kPanel + "load_remove_1");
  C3DE_WAIT(window, "it is removed", row(s, "Force 1").empty());
  CHECK(window.state()["notifications"].empty());
}
