// SPDX-License-Identifier: Apache-2.0
// Plugins that have ended a run, and the plugin manager.
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "support/environment.h"
#include "ui/workstation_driver.h"

using c3de::test::Json;
using c3de::test::WorkstationDriver;

namespace {

namespace fs = std::filesystem;

/// A user with an own plugin, and nothing to simulate.
struct Person {
  explicit Person(const std::string &name)
      : folder(c3de::test::outputFile(name)), home("C3DE_HOME", (folder / "home").string()) {
    fs::remove_all(folder);
    fs::create_directories(folder / "plugins");
    fs::copy_file(C3DE_DYING_PLUGIN, folder / "plugins" / fs::path(C3DE_DYING_PLUGIN).filename());
    std::ofstream(folder / "no_mesh.obj") << "this is no mesh\n";
  }
  [[nodiscard]] std::vector<std::string> arguments() const {
    return {(folder / "no_mesh.obj").string(), "--plugin-path", (folder / "plugins").string()};
  }
  fs::path folder;
  ScopedEnvironment home;
};

const std::string kFile = "plugins/" + fs::path(C3DE_DYING_PLUGIN).filename().string();

bool isAsked(const Json &state) { return state["values"].contains("crash/text"); }

void openManager(WorkstationDriver &window) {
  window.key("ctrl+shift+p");
  C3DE_WAIT(window, "the manager is open", s["widgets"].contains("plugin/test.dying"));
}

/// The choice of that number in the message about a call that has not returned; the newest message is first.
void clickChoice(WorkstationDriver &window, int number) {
  const Json messages = window.state()["notifications"];
  for (std::size_t i = 0; i < messages.size(); ++i)
    if (messages[i].dump().find(" s so far.") != std::string::npos)
      return window.click("notification/choose." + std::to_string(messages.size() - 1 - i) + "." +
                          std::to_string(number));
}

}  // namespace

TEST_CASE("a plugin that has ended the window is asked about, and stays off until it is switched on", "[crash]") {
  C3DE_WINDOW_OR_SKIP();
  const Person person("crash");
  {
    WorkstationDriver window("crash_dies");
    const ScopedEnvironment place("C3DE_TEST_DIES", "panel");
    CHECK(window.startAndWait(person.arguments()) >= 128);
    CHECK_THAT(window.logText(),
               Contains("c3de: fatal: SIGABRT") && Contains("in plugin test.dying (on_ui of a panel)"));
  }
  {
    WorkstationDriver window("crash_asks");
    window.start(person.arguments());
    const Json asked = window.waitUntil("it asks", isAsked);
    const std::string text = asked["values"]["crash/text"];
    CHECK_THAT(text, Contains("The last run ended by SIGABRT") && Contains("test.dying"));
    CHECK_FALSE(asked["values"].contains("panel/test.dying.panel"));
    window.screenshot("asks");
    window.key("Return");
    C3DE_WAIT(window, "it goes on", !isAsked(s) && s["notifications"].size() == 1);
    openManager(window);
    CHECK_THAT(window.value("plugins/Dying"), Contains("off: switched off"));
    CHECK(window.value("plugins/note").empty());
    window.screenshot("manager");
    window.click("plugin/test.dying");
    window.waitForValue("plugins/note", "Takes effect at the next start of the program.");
    window.screenshot("pending");
    window.key("Escape");
    window.key("ctrl+q");
    CHECK(window.waitForExit() == 0);
  }
  {
    WorkstationDriver window("crash_after");
    window.start(person.arguments());
    C3DE_WAIT(window, "it is there", s["notifications"].size() == 1);
    CHECK_FALSE(isAsked(window.state()));  // it was answered
    openManager(window);
    CHECK(window.value("plugins/Dying") == "loaded 1.0.0");
    window.click("plugin/test.dying");
    window.waitForValue("plugins/note", "Takes effect at the next start of the program.");
  }
}

TEST_CASE("safe mode is one of the answers, and holds for one run", "[crash]") {
  C3DE_WINDOW_OR_SKIP();
  const Person person("crash_safe");
  {
    WorkstationDriver window("crash_safe_dies");
    const ScopedEnvironment place("C3DE_TEST_DIES", "create");
    auto arguments = person.arguments();
    arguments.emplace_back("--trust-plugins");
    CHECK(window.startAndWait(arguments) >= 128);
  }
  {
    WorkstationDriver window("crash_safe_asks");
    window.start(person.arguments());
    window.waitUntil("it asks", isAsked);
    window.click("crash/safe_mode");
    C3DE_WAIT(window, "it says so", s["notifications"].dump().find("Safe mode") != std::string::npos);
    window.key("ctrl+shift+p");
    C3DE_WAIT(window, "the manager is open", s["values"].contains(kFile));
    CHECK_THAT(window.value(kFile), Contains("safe mode"));
    window.screenshot("manager");
  }
  WorkstationDriver window("crash_safe_after");
  window.start(person.arguments());
  openManager(window);
  CHECK(window.value("plugins/Dying") == "loaded 1.0.0");
}

TEST_CASE("a job and a step that do not get on are told, and ended by a click", "[hangs]") {
  C3DE_WINDOW_OR_SKIP();
  const auto isTold = [](const Json &s) { return s["notifications"].dump().find(" s so far.") != std::string::npos; };
  {
    const Person person("hangs_job");
    const ScopedEnvironment place("C3DE_TEST_DIES", "silent job");
    WorkstationDriver window("hangs_job");
    auto arguments = person.arguments();
    arguments.emplace_back("--trust-plugins");  // otherwise it is refused for it
    window.start(arguments);
    C3DE_WAIT(window, "the job runs", !s["jobs"].empty());
    window.waitUntil("it is told", isTold);
    window.screenshot("told");
    clickChoice(window, 0);
    C3DE_WAIT(window, "the job is over", s["jobs"].empty());
  }
  const Person person("hangs_step");
  const ScopedEnvironment place("C3DE_TEST_DIES", "slow step");
  WorkstationDriver window("hangs_step");
  auto arguments = person.arguments();
  arguments[0] = (fs::path(testResourcesFolder()) / "scenes" / "first_light.toml").string();
  window.start(arguments);
  C3DE_WAIT(window, "the organ is there", s["transport"]["exists"].get<bool>());
  window.key("space");
  window.waitUntil("it is told", isTold);
  window.screenshot("told");
  clickChoice(window, 0);
  C3DE_WAIT(window, "it has stopped", s["transport"]["mode"] == "stopped");
  CHECK(window.state()["transport"]["steps"] == 0);
}
