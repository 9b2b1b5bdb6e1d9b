// SPDX-License-Identifier: Apache-2.0
// Sessions in the window: saved, opened, asked about, recovered after a crash.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

std::string title(const Json &state) { return state["title"].get<std::string>(); }

/// Plays for a while, then pauses.
Json simulate(WorkstationDriver &window, int steps) {
  const int before = window.state()["transport"]["steps"];
  play(window);
  C3DE_WAIT(window, "it advances", s["transport"]["steps"].get<int>() >= before + steps);
  return pause(window);
}

}  // namespace

TEST_CASE("a session is saved with its changes and continues in another window", "[session_saved]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = freshFile("organ.c3de"), again = freshFile("again.c3de");
  Json paused;
  {
    WorkstationDriver window("session_saved");
    startOrgan(window);
    CHECK(title(window.state()) == "Floating organ - C3DE");
    window.enterNumber(kPanel + "material.youngs_modulus", "9000 Pa");
    C3DE_WAIT(window, "the stiffness is set", row(s, "material.youngs_modulus") == "9 kPa");
    window.moveTo(window.inView(0.9, 0.9));
    simulate(window, 20);
    // A pull leaves the organ deformed.
    takePinch(window);
    play(window);
    pull(window, window.inView(0.5, 0.5), window.inView(0.65, 0.4));
    window.release();
    paused = pause(window);
    CHECK(title(paused) == "Floating organ* - C3DE");
    window.key("ctrl+s");
    window.enterFile(file);
    waitForMessage(window, "Session saved");
    CHECK(title(window.state()) == "organ.c3de - C3DE");
    window.screenshot("saved");
    // Nothing is lost now.
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  const Json saved = describe(file);
  CHECK(saved["steps"] == paused["transport"]["steps"]);
  WorkstationDriver window("session_opened");
  window.start({file.string()});
  const Json opened = C3DE_WAIT(
      window, "it is opened",
      s["jobs"].empty() && s["transport"]["steps"] == paused["transport"]["steps"] && !row(s, "Surfels").empty());
  CHECK(title(opened) == "organ.c3de - C3DE");
  CHECK(opened["notifications"].empty());
  CHECK(row(opened, "material.youngs_modulus") == "9 kPa");
  window.screenshot("opened");
  window.key("ctrl+shift+s");
  window.enterFile(again);
  waitForMessage(window, "Session saved");
  CHECK(describe(again)["state_hash"] == saved["state_hash"]);

  // It continues, and quitting offers to save.
  simulate(window, 20);
  CHECK(title(window.state()) == "again.c3de* - C3DE");
  window.key("ctrl+q");
  C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
  window.screenshot("asked");
  window.key("Return");
  CHECK(window.waitForExit() == 0);
  CHECK(describe(again)["steps"].get<int>() >= paused["transport"]["steps"].get<int>() + 20);
}

TEST_CASE("work that was not saved is offered after the program was killed", "[session_recovered]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path home = outputFile("recovered_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  const auto recoveryFile = [&] { return recoveryIn(home); };
  int steps = 0;
  {
    WorkstationDriver window("session_killed");
    startOrgan(window);
    steps = simulate(window, 30)["transport"]["steps"];
    window.waitUntil("the paused state is backed up", [&](const Json &) {
      const fs::path file = recoveryFile();
      return !file.empty() && describe(file)["steps"] == steps;
    });
    window.kill();
  }
  CHECK(!recoveryFile().empty());
  WorkstationDriver window("session_recovered");
  window.start({});
  waitForMessage(window, "Unsaved work of ");
  window.screenshot("offered");
  window.click("notification/choose.0.0");
  C3DE_WAIT(window, "it is restored", s["jobs"].empty() && s["transport"]["steps"] == steps);
  CHECK(title(window.state()) == "Floating organ* - C3DE");
  window.screenshot("restored");
  const fs::path file = freshFile("recovered.c3de");
  window.key("ctrl+s");
  window.enterFile(file);
  waitForMessage(window, "Session saved");
  CHECK(describe(file)["steps"] == steps);
  window.key("ctrl+q");
  CHECK(window.waitForExit() == 0);
  CHECK(recoveryFile().empty());
}

TEST_CASE("a recorded pull is repeated with equal state hashes by any number of threads", "[session_recorded]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path file = freshFile("pull.c3dr");
  {
    WorkstationDriver window("session_recorded");
    startOrgan(window);
    simulate(window, 20);
    window.clickMenu("simulation.start_recording");
    window.enterFile(file);
    waitForMessage(window, "Recording");
    CHECK(window.value("status/recording") == "Recording");
    window.screenshot("recording");
    takePinch(window);
    play(window);
    pull(window, window.inView(0.5, 0.5), window.inView(0.65, 0.4));
    window.release();
    window.enterNumber(kPanel + "material.youngs_modulus", "9000 Pa");
    C3DE_WAIT(window, "it continues", s["transport"]["steps"].get<int>() > 200);
    window.moveTo(window.inView(0.9, 0.9));
    window.key("ctrl+z");
    window.key("ctrl+r");
    C3DE_WAIT(window, "it is reset and continues", s["transport"]["steps"].get<int>() > 50);
    pause(window);
    window.clickMenu("simulation.stop_recording");
    waitForMessage(window, "Recording saved");
    window.key("ctrl+q");
    C3DE_WAIT(window, "it asks", s["values"].contains("quit/text"));
    window.clickToEnd("quit/quit");
    CHECK(window.waitForExit() == 0);
  }
  checkReplays(file);
}

TEST_CASE("a recovery file that cannot be written is reported once, and the simulation continues",
          "[session_unwritable]") {
  C3DE_ORGAN_OR_SKIP();
  // A file where the folder should be; C3DE_TEST_HOME may name a full disk instead.
  fs::path home = freshFile("no_home");
  std::ofstream(home) << "not a folder";
  if (const char *given = std::getenv("C3DE_TEST_HOME")) home = given;
  const ScopedEnvironment user("C3DE_HOME", home.string());
  WorkstationDriver window("session_unwritable");
  // No setting can be stored: the panel is that of a new user.
  window.start({floatingOrgan().string()});
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"] == true && s["jobs"].empty());
  window.moveTo(window.inView(0.9, 0.9));
  play(window);
  waitForMessage(window, "Autosave failed");
  window.screenshot("reported");
  const int steps = window.state()["transport"]["steps"];
  // Two more attempts.
  C3DE_WAIT(window, "it continues", s["transport"]["steps"].get<int>() > steps + 5000);
  const std::string messages = window.state()["notifications"].dump();
  const std::size_t first = messages.find("Autosave failed");
  CHECK(first != std::string::npos);
  CHECK(messages.find("Autosave failed", first + 1) == std::string::npos);
  const fs::path file = freshFile("elsewhere.c3de");
  window.moveTo(window.inView(0.9, 0.9));
  window.key("ctrl+s");
  window.enterFile(file);
  waitForMessage(window, "Session saved");
  CHECK(describe(file)["state_hash"].is_string());
  window.kill();
}
