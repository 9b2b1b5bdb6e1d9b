// SPDX-License-Identifier: Apache-2.0
// Random work in the window: its recording is replayed with equal state hashes, and what is on disk after kill -9 is at
// most ten seconds old and resumes. Cases of many walks are [.walks]:
//   xvfb-run -a -s "-screen 0 1400x900x24" bin/test_ui "[.walks]"
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <random>
#include <sstream>
#include <thread>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/program_command.h"
#include "ui/session_window.h"
#include "ui/simulation_window.h"
#include "ui/workstation_driver.h"
#include "ui/workstation_state.h"

using namespace c3de;
using namespace c3de::test;

namespace {

namespace fs = std::filesystem;

/// -1 … 1, the same on every machine.
double fraction(std::mt19937_64 &random) { return static_cast<double>(random() >> 11) / 0x1p52 - 1.0; }

/// Actions of a user, in random order, by mouse and keyboard.
class Walk {
 public:
  Walk(WorkstationDriver &window, std::uint64_t seed) : window_(window), random_(seed) {}

  void act() {
    switch (choice(9)) {
      case 0:
      case 1: drag("p"); break;
      case 2: drag("t"); break;
      case 3: drag("g"); break;
      case 4:
        window_.enterNumber(kPanel + "material.youngs_modulus", std::to_string(4000 + 500 * choice(12)) + " Pa");
        break;
      case 5: window_.key("ctrl+z"); break;
      case 6: window_.key("ctrl+y"); break;
      case 7: window_.key("x"); break;  // removes instrument or jaws
      case 8:
        if (choice(3) == 0) window_.key("ctrl+r");
        break;
      default: break;
    }
  }

 private:
  int choice(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  Point nearMiddle(double range) {
    const double u = 0.5 + range * fraction(random_), v = 0.5 + range * fraction(random_);
    return window_.inView(u, v);
  }
  void drag(const std::string &tool) {
    const Point from = nearMiddle(0.08), to = nearMiddle(0.25);
    window_.moveTo(from);
    window_.key(tool);
    window_.drag(from, to, 6);
    window_.moveTo(window_.inView(0.9, 0.9));
  }

  WorkstationDriver &window_;
  std::mt19937_64 random_;
};

void makeSureItPlays(WorkstationDriver &window) {
  if (mode(window.state()) != "playing") play(window);
}

/// Records a walk and replays the recording.
void checkWalk(std::uint64_t seed, int actions) {
  CAPTURE(seed);
  const fs::path file = freshFile("walk_" + std::to_string(seed) + ".c3dr");
  {
    WorkstationDriver window("session_walk_" + std::to_string(seed));
    startOrgan(window);
    window.clickMenu("simulation.start_recording");
    window.enterFile(file);
    C3DE_WAIT(window, "it records", s["values"].contains("status/recording"));
    Walk walk(window, seed);
    for (int action = 0; action < actions; ++action) {
      makeSureItPlays(window);
      walk.act();
    }
    pause(window);
    window.clickMenu("simulation.stop_recording");
    waitForMessage(window, "Recording saved");
    window.kill();
  }
  checkReplays(file);
}

/// Wall-clock seconds between the time that a session names and a later time.
double ageOf(const Json &described, std::time_t later) {
  std::tm utc{};
  std::istringstream(described["saved"].get<std::string>()) >> std::get_time(&utc, "%Y-%m-%dT%H:%M:%S");
  return std::difftime(later, timegm(&utc));
}

/// Kills the program at a random time of a walk. Its recovery file is new enough and resumes.
void checkKill(std::uint64_t seed) {
  CAPTURE(seed);
  const fs::path home = outputFile("walk_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  std::time_t killed = 0;
  {
    WorkstationDriver window("session_kill");
    startOrgan(window);
    std::mt19937_64 random(seed);
    const double seconds = 22.0 + 8.0 * fraction(random);
    Walk walk(window, seed);
    const auto begin = std::chrono::steady_clock::now();
    // From another thread, so that it happens within an action.
    std::thread killer([&] {
      std::this_thread::sleep_until(
          begin + std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds)));
      killed = std::time(nullptr);
      window.kill();
    });
    try {
      while (std::chrono::steady_clock::now() < begin + std::chrono::minutes(2)) {
        makeSureItPlays(window);
        walk.act();
      }
    } catch (const std::exception &) {  // the window is not there any more
    }
    killer.join();
  }
  const fs::path file = recoveryIn(home);
  REQUIRE(!file.empty());
  const Json described = describe(file);
  // A write that was interrupted leaves the file before.
  CHECK(ageOf(described, killed) <= 10.0 + 1.0);  // the file names whole seconds
  const auto resumed = runProcess(
      programCommand({"run", file.string(), "--steps", std::to_string(described["steps"].get<int>() + 20)}), 120.0);
  REQUIRE(resumed);
  INFO(resumed->errorOutput);
  CHECK(resumed->exitCode == 0);
}

}  // namespace

TEST_CASE("random work is recorded and replayed with equal state hashes", "[session_walk]") {
  C3DE_ORGAN_OR_SKIP();
  checkWalk(1, 10);
}

TEST_CASE("twenty random walks are replayed with equal state hashes", "[.walks]") {
  C3DE_ORGAN_OR_SKIP();
  for (std::uint64_t seed = 2; seed <= 20; ++seed) checkWalk(seed, 15);
}

TEST_CASE("after fifty kills at random times at most ten seconds are lost", "[.walks][.kills]") {
  C3DE_ORGAN_OR_SKIP();
  const char *number = std::getenv("C3DE_KILLS");
  const std::uint64_t kills = number ? std::strtoull(number, nullptr, 10) : 50;
  for (std::uint64_t seed = 1; seed <= kills; ++seed) checkKill(seed);
}

TEST_CASE("a pull that the end of the program interrupted is restored, and can be released", "[session_held]") {
  C3DE_ORGAN_OR_SKIP();
  const fs::path home = outputFile("held_home");
  fs::remove_all(home);
  const ScopedEnvironment user("C3DE_HOME", home.string());
  {
    WorkstationDriver window("session_held_killed");
    startOrgan(window);
    takePinch(window);
    play(window);
    pull(window, window.inView(0.5, 0.5), window.inView(0.65, 0.4));
    C3DE_WAIT(window, "it is held", numberOf(s, kPanel + "Pinch force") > 0.0);
    const int steps = window.state()["transport"]["steps"];
    window.waitUntil("the state is backed up while it is held", [&](const Json &) {
      const fs::path file = recoveryIn(home);
      return !file.empty() && describe(file)["steps"].get<int>() > steps + 10;
    });
    window.screenshot("held");
    window.kill();
  }
  WorkstationDriver window("session_held");
  window.start({});
  waitForMessage(window, "Unsaved work of ");
  window.click("notification/choose.0.0");
  C3DE_WAIT(window, "it is restored", s["jobs"].empty() && !row(s, "Pinch force").empty());
  window.moveTo(window.inView(0.5, 0.5));
  window.key("p");
  const Json restored = C3DE_WAIT(window, "it is still held", row(s, "Held inside") == "organ");
  CHECK(restored["notifications"].empty());
  window.screenshot("restored");
  play(window);
  window.moveTo(window.inView(0.3, 0.3));  // the hand does not follow: no button is pressed
  window.waitFrames(3);
  CHECK(row(window.state(), "Held inside") == "organ");
  window.key("Escape");
  C3DE_WAIT(window, "it is released", row(s, "Pinch force") == "–");
  window.kill();
}
