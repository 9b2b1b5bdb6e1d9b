// SPDX-License-Identifier: Apache-2.0
// Steps of the simulation: play, pause, single steps, reset, and steps that take long.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>

#include "support/catch.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// Nearly incompressible in implicit steps: many seconds for each.
fs::path heavyScene(const std::string &solver, int count = 12000) {
  fs::path scene = outputFile("heavy_" + std::to_string(count) + ".toml");
  std::ofstream(scene)
      << "format = 1\ntitle = \"Heavy organ\"\n[solver]\nintegrator = \"implicit\"\n"
      << solver << "\n[[body]]\n"
      << "name = \"organ\"\nmesh = \"" << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
      << "material = { law = \"neo_hookean\", youngs_modulus = 2e6, poisson_ratio = 0.499, density = 1000.0 }\n"
      << "sampling = { count = " << count << " }\nangular_velocity = [0.0, 0.0, 40.0]\n";
  return scene;
}

}  // namespace

TEST_CASE("play, pause, step and reset do what they say, and reset is exact", "[organ_transport]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_transport");
  startOrgan(window);
  const std::string initial =
      C3DE_WAIT(window, "the initial state is shown", !row(s, "State hash").empty())["values"][kPanel + "State hash"];
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
  window.choose("toolbar/rate", "1/4×");
  C3DE_WAIT(window, "the rate is set", s["transport"]["target_rate"] == 0.25);
  // Stop returns to the start, too.
  window.key("space");
  C3DE_WAIT(window, "it plays", mode(s) == "playing" && s["transport"]["steps"] > 2);
  window.click("toolbar/stop");
  C3DE_WAIT(window, "it has stopped", mode(s) == "stopped" && s["transport"]["steps"] == 0);
}

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
  window.enterNumber(kPanel + "sampling.count", "200");
  window.click(kPanel + "rebuild");
  C3DE_WAIT(window, "it is filled again", std::stod(row(s, "Phyxels")) < 300.0);
  window.moveTo(window.inView(0.9, 0.1));
  window.key("space");
  C3DE_WAIT(window, "it moves", s["transport"]["steps"] > 2);
}

TEST_CASE("while a hand holds it no step is given up, and the status bar says that it is slow", "[organ_hand_budget]") {
  C3DE_ORGAN_OR_SKIP();
  WorkstationDriver window("organ_hand_budget");
  // No step fits into this budget.
  openOrgan(window, {heavyScene("step_budget = 0.01", 1000).string()});
  takePinch(window);
  const Point from = window.inView(0.5, 0.5);
  holdSurfel(window, from);
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
  const fs::path scene = outputFile("stiff_edit.toml");
  std::ofstream(scene) << "format = 1\n[solver]\nintegrator = \"implicit\"\n[[body]]\nname = \"organ\"\nmesh = \""
                       << organMesh().generic_string() << "\"\nmesh_unit = \"mm\"\n"
                       << "material = { law = \"neo_hookean\", youngs_modulus = 1e4, poisson_ratio = 0.4, density = "
                          "1000.0 }\nsampling = { count = 989 }\nangular_velocity = [0.0, 0.0, 20.0]\n";
  WorkstationDriver window("organ_stiff_edit");
  window.start({scene.string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"] == true);
  window.moveTo(window.inView(0.9, 0.1));
  play(window);
  for (const auto &[id, value] :
       {std::pair("material.poisson_ratio", "0.499"), std::pair("material.youngs_modulus", "2e6 Pa")})
    window.enterNumber(kPanel + id, value);
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
