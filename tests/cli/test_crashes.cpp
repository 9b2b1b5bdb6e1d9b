// SPDX-License-Identifier: Apache-2.0
// Plugins that end the program: the message, and how to continue.
#include "program.h"
#include "support/environment.h"

namespace {

namespace fs = std::filesystem;

/// A separate user, with an own copy of the plugin and a scene.
class Person {
 public:
  explicit Person(const std::string &name)
      : folder_(freshFolder(name)), home_("C3DE_HOME", (folder_ / "home").string()) {
    fs::create_directories(folder_ / "plugins");
    plugin = folder_ / "plugins" / ("dying" + std::string(c3de::pluginExtension()));
    fs::copy_file(C3DE_DYING_PLUGIN, plugin);
    scene_ = writeBoxScene(folder_);
  }

  /// @param dies  where the plugin crashes; empty: nowhere
  [[nodiscard]] c3de::ProcessResult run(const std::string &dies, const std::vector<std::string> &more = {}) const {
    const ScopedEnvironment place("C3DE_TEST_DIES", dies);
    std::vector<std::string> arguments{"run", scene_.string(), "--steps",
                                       "2",   "--plugin-path", plugin.parent_path().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runC3de(arguments);
  }
  [[nodiscard]] c3de::ProcessResult plugins(const std::vector<std::string> &more = {},
                                            const std::string &dies = {}) const {
    const ScopedEnvironment place("C3DE_TEST_DIES", dies);
    std::vector<std::string> arguments{"plugins", "--plugin-path", plugin.parent_path().string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runC3de(arguments);
  }
  /// The entry of the plugin in `c3de plugins --json`.
  [[nodiscard]] nlohmann::json listed(const std::vector<std::string> &more = {}) const {
    std::vector<std::string> arguments{"--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto all = nlohmann::json::parse(plugins(arguments).output);
    for (const auto &one : all.at("plugins"))
      if (one.at("path").get<std::string>().find("dying") != std::string::npos) return one;
    return {};
  }

  [[nodiscard]] fs::path home() const { return folder_ / "home"; }

  fs::path plugin;

 private:
  fs::path folder_;
  ScopedEnvironment home_;
  fs::path scene_;
};

// What ends a process that writes at an invalid address.
#if defined(_WIN32)
constexpr const char *kInvalidAccess = "0xC0000005";
#else
constexpr const char *kInvalidAccess = "SIGSEGV";
#endif

/// An exit code of a program that the system has ended.
bool isCrash(int exitCode) {
#if defined(_WIN32)
  return exitCode < 0 || exitCode == 3;  // the code of an exception, or abort()
#else
  return exitCode >= 128;
#endif
}

}  // namespace

TEST_CASE("a plugin that dies, hangs or exits at its first use is refused, and the run goes on") {
  struct Case {
    const char *where, *said;
  };
  for (const Case &one : {
         Case{"loading", "(loading of its library)"}, Case{"create", "in plugin test.dying (create)"},
             Case{"thread", "in plugin test.dying (on its own thread)"}, Case{"create exit", "by exit() within create"},
             Case{"create thread exit", "plugin test.dying has ended the program, by exit()"},
#if !defined(_WIN32)  // where _Exit() is not noticed
             Case{"create _Exit", "by _Exit() within create"},
             Case{"create thread _Exit", "plugin test.dying has ended the program, by _Exit()"},
#endif
             Case {
           "hang", "had not come to an end after 5 s"
         }
       }) {
    INFO(one.where);
    const Person person(std::string("first-use-") + one.where);
    const auto result = person.run(one.where);
    INFO(result.errorOutput);
    CHECK(result.exitCode == 0);
    CHECK_THAT(result.errorOutput, Contains("refused: its first use, in a separate process,") && Contains(one.said) &&
                                       Contains("--trust-plugins"));
    // It is remembered from then on, until the file changes.
    CHECK_THAT(person.run("").errorOutput, Contains(one.said));
    fs::last_write_time(person.plugin, fs::last_write_time(person.plugin) + std::chrono::seconds(2));
    CHECK(person.run("").errorOutput.find("refused") == std::string::npos);
    CHECK(person.listed().at("state") == "loaded");
  }
}

TEST_CASE("who trusts a plugin sees what ends his run, and is told again at the next start") {
  for (const char *where : {"create", "step", "thread"}) {
    INFO(where);
    const Person person(std::string("trusted-") + where);
    const auto died = person.run(where, {"--trust-plugins"});
    CHECK(isCrash(died.exitCode));
    const std::string place = where == std::string("create") ? "(create)"
                              : where == std::string("step") ? "(apply of a force field)"
                                                             : "(on its own thread)";
    const std::string how = where == std::string("step") ? kInvalidAccess : "SIGABRT";
    CHECK_THAT(died.errorOutput, Contains("c3de: fatal: " + how) && Contains("in plugin test.dying " + place));
    const auto next = person.run("");
    CHECK(next.exitCode == 0);
    CHECK_THAT(next.errorOutput, Contains("the last run ended by " + how) &&
                                     Contains("in plugin test.dying " + place) && Contains("--without test.dying") &&
                                     Contains("--safe-mode"));
    CHECK(person.run("").errorOutput.find("the last run") == std::string::npos);  // reported once
    CHECK_THAT(person.plugins().output, Contains("crashed  test.dying: one run ended by " + how));
  }
}

TEST_CASE("the first use of a plugin leaves nothing in its settings") {
  const Person person("first-use-settings");
  REQUIRE(person.run("nowhere, and counts").exitCode == 0);
  const fs::path file = person.home() / "config" / "settings" / "test.dying.json";
  REQUIRE(fs::exists(file));
  CHECK(readJson(file).at("lives") == "1");
}

TEST_CASE("a plugin that ends a run is named, the run has failed, and the next one says why") {
  struct Case {
    const char *where, *said;
  };
  for (const Case &one : {
         Case{"step exit", "by exit() within apply of a force field"},
#if !defined(__MINGW32__)
             Case{"step quick_exit", "by quick_exit() within apply of a force field"},
#endif
#if !defined(_WIN32)  // where _Exit() is not noticed
             Case{"step _Exit", "by _Exit() within apply of a force field"},
             Case{"step thread _Exit", "by _Exit() on a thread of its own"},
#endif
             Case {
           "step thread exit", "by exit() on a thread of its own"
         }
       }) {
    INFO(one.where);
    const Person person(std::string("ends-the-run-") + one.where);
    const auto ended = person.run(one.where);
    INFO(ended.errorOutput);
    CHECK(ended.exitCode == 4);
    CHECK_THAT(ended.errorOutput, Contains(std::string("plugin test.dying has ended the program, ") + one.said));
    const auto next = person.run("");
    CHECK(next.exitCode == 0);
    CHECK_THAT(next.errorOutput, Contains("the last run ended by ") && Contains("xit(), in plugin test.dying (") &&
                                     Contains("--without test.dying"));
  }
  const Person person("ends-a-child");
  CHECK(person.run("step child _exit").exitCode == 0);
}

TEST_CASE("a simulator that dies while it builds a body is named, with the call") {
  const auto folder = freshFolder("dies-building");
  const ScopedEnvironment home("C3DE_HOME", (folder / "home").string()), place("C3DE_TEST_DIES", "add_body");
  (void)writeBoxScene(folder);
  const auto scene =
      writeFile(folder / "scene.toml", "format = 1\n[[body]]\nname = \"box\"\nmesh = \"box.obj\"\nmesh_unit = \"m\"\n");
  const auto died =
      runC3de({"run", scene.string(), "--steps", "1", "--no-plugins", "--plugin", C3DE_RECORDER, "--trust-plugins"});
  CHECK(isCrash(died.exitCode));
  CHECK_THAT(died.errorOutput, Contains("c3de: fatal: SIG") && Contains("in plugin test.recorder (building a body)"));
}

TEST_CASE("a plugin can be left out, for one run or for all") {
  const Person person("left-out");
  REQUIRE(person.listed().at("state") == "loaded");
  for (const char *name : {"test.dying", "dying"}) {
    const auto without = person.run("step", {"--without", name});
    CHECK(without.exitCode == 0);
    const auto off = person.listed({"--without", name});
    CHECK(off.at("state") == "off");
    CHECK_THAT(off.at("reason").get<std::string>(), Contains(std::string("--without ") + name));
  }
  CHECK(person.run("step", {"--safe-mode"}).exitCode == 0);
  CHECK_THAT(person.listed({"--safe-mode"}).at("reason").get<std::string>(), Contains("safe mode"));
  const auto nobody = person.run("", {"--without", "test.dyin"});
  CHECK(nobody.exitCode == 0);
  CHECK_THAT(nobody.errorOutput, Contains("--without test.dyin: no plugin has this id or file"));
  const auto both = person.run("", {"--safe-mode", "--plugin", person.plugin.string()});
  CHECK(both.exitCode == 2);
  CHECK_THAT(both.errorOutput, Contains("--safe-mode") && Contains("--plugin"));

  CHECK_THAT(person.plugins({"--off", "test.dying"}).output, Contains("test.dying stays off"));
  CHECK(person.listed().at("state") == "off");
  CHECK_THAT(person.listed().at("reason").get<std::string>(), Contains("c3de plugins --on test.dying"));
  CHECK(person.run("step").exitCode == 0);
  // Naming the file explicitly loads it.
  CHECK(isCrash(person.run("step", {"--plugin", person.plugin.string()}).exitCode));
  const auto misspelt = person.plugins({"--on", "test.diying"});
  CHECK(misspelt.exitCode == 2);
  CHECK_THAT(misspelt.errorOutput, Contains("did you mean test.dying?"));
  CHECK(person.plugins({"--on", "test.dying"}).exitCode == 0);
  CHECK(person.listed().at("state") == "loaded");
}
