// SPDX-License-Identifier: Apache-2.0
// c3de-validate accepts good plugins, and reports the fault of each bad one in the listed check.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "c3de/core/platform.h"
#include "support/catch.h"
#include "support/environment.h"

using Json = nlohmann::json;

namespace {

namespace fs = std::filesystem;

struct Validated {
  int exitCode = -1;
  std::string output, errorOutput;
  Json checks;  ///< of the first plugin

  [[nodiscard]] Json of(const std::string &check) const {
    for (const Json &one : checks)
      if (one["check"] == check) return one;
    return {};
  }
};

Validated validate(const std::string &plugin, std::vector<std::string> options = {}) {
  // Cases run concurrently, each in its own process.
  static const auto process = std::chrono::steady_clock::now().time_since_epoch().count();
  const fs::path report = fs::path(testOutputRoot()) / ("validate-" + std::to_string(process) + ".json");
  fs::create_directories(report.parent_path());
  fs::remove(report);
  options.insert(options.begin(), {C3DE_VALIDATE, plugin, "--json", report.string()});
  const auto ended = c3de::runProcess(options, 500.0);
  REQUIRE(ended);
  CHECK_FALSE(ended->timedOut);
  Validated out{ended->exitCode, ended->output, ended->errorOutput, {}};
  if (fs::exists(report)) {
    std::ifstream file(report);
    out.checks = Json::parse(file)["plugins"][0]["checks"];
  }
  fs::remove(report);
  return out;
}

std::string testPlugin(const std::string &name) {
  return (fs::path(C3DE_TEST_PLUGINS) / (name + c3de::pluginExtension())).string();
}

// What ends a process that reads or writes at an invalid address.
#if defined(_WIN32)
constexpr const char *kInvalidAccess = "0xC0000005";
#else
constexpr const char *kInvalidAccess = "SIGSEGV";
#endif

}  // namespace

TEST_CASE("good plugins pass every check") {
  for (const char *name : {C3DE_HELLO, C3DE_CLAMP, C3DE_MAGNET, C3DE_MESH_READER, C3DE_IMAGE_SAMPLES, C3DE_MASS_SPRING,
                           C3DE_BASELINES, C3DE_POINTBASED}) {
    const Validated good = validate(name);
    INFO(good.output);
    CHECK(good.exitCode == 0);
    CHECK_THAT(good.output, Contains("good: "));
    for (const Json &one : good.checks) CHECK((one["result"] == "pass" || one["result"] == "skip"));
  }
  // Its effect on another plugin's simulator is checked where that simulator exists.
  CHECK(validate(C3DE_MATERIAL_LAW, {"--with", C3DE_POINTBASED}).exitCode == 0);
}

TEST_CASE("a good plugin may require what every run serves, or a window") {
  for (const char *name : {"requires_params", "requires_panels"}) {
    const Validated good = validate(testPlugin(name));
    INFO(good.output);
    CHECK(good.exitCode == 0);
    CHECK(good.of("lifecycle.headless")["result"] == "pass");
  }
  CHECK_THAT(validate(testPlugin("requires_panels")).of("lifecycle.headless")["text"].get<std::string>(),
             Contains("refuses itself: needs c3de.panels/1"));
}

TEST_CASE("plugins that are refused fail in the check that says why") {
  struct Bad {
    const char *plugin, *check, *says;
  };
  for (const Bad &bad : {
#if defined(_WIN32)
         Bad{"no_entry", "entry", "no function c3de_plugin_query"},  // without nm
#else
         Bad{"no_entry", "file.exports", "exports no function c3de_plugin_query"},
#endif
             Bad{"declines", "entry", "needs a licence key"}, Bad{"null_plugin", "entry", "no descriptor"},
             Bad{"null_create", "descriptor", "create is null"}, Bad{"null_start", "descriptor", "start is null"},
             Bad{"null_stop", "descriptor", "stop is null"}, Bad{"null_destroy", "descriptor", "destroy is null"},
             Bad{"size_zero", "descriptor", "size is 0"}, Bad{"size_four", "descriptor", "size is 4"},
             Bad{"size_huge", "descriptor", "size is 2147483648"}, Bad{"empty_id", "descriptor", "id: is empty"},
             Bad{"id_not_utf8", "descriptor", "id: is not UTF-8"}, Bad{"huge_needs", "descriptor", "at most 256"},
             Bad{"unknown_service", "descriptor", "did you mean c3de.log/1?"},
             Bad{"too_new_revision", "descriptor", "rev >= 3, host has 2"},
             Bad{"wrong_abi_major", "descriptor", "built for plugin ABI 7"},
             Bad{"class_twice", "lifecycle", "is registered by plugin test.class_twice already"},
             Bad{"fails_in_create", "lifecycle", "the moon is in the wrong phase"},
             Bad{"fails_in_start", "lifecycle", "the moon is in the wrong phase"},
             Bad{"throws_in_query", "entry", "thrown in query"},
             Bad{"throws_in_create", "lifecycle", "thrown in create"},
             Bad{"sdk_throws", "lifecycle", "the presets cannot be read"},
             Bad{"exits_in_create", "lifecycle", "has ended the program, by exit() within create"},
             Bad{"exits_in_panel", "panels", "has ended the program"},
#if !defined(_WIN32)
             Bad{"missing_library", "file.load", "c3de_test_gone"},
             Bad{"undefined_symbol", "file.load", "a_function_that_nobody_has"},
#endif
       }) {
    INFO(bad.plugin);
    const Validated found = validate(testPlugin(bad.plugin), {"--only", "^(file|entry|descriptor|lifecycle$|panels)"});
    INFO(found.output);
    CHECK(found.exitCode == 1);
    CHECK_THAT(found.output, Contains("BAD: "));
    const Json verdict = found.of(bad.check);
    REQUIRE(verdict.is_object());
    CHECK(verdict["result"] == "fail");
    CHECK_THAT(verdict["text"].get<std::string>(), Contains(bad.says));
  }
}

TEST_CASE("each way to misbehave is found by the check beside it", "[slow]") {
  struct Mode {
    const char *mode, *check, *result, *says;
  };
  std::vector<Mode> modes{
      {"entry_dies", "entry", "fail", kInvalidAccess},
      {"entry_is_slow", "entry", "fail", "at most 10 ms"},
      {"entry_changes", "entry", "fail", "another descriptor each time"},
      {"entry_takes_every_host", "entry.other-abi", "fail", "must refuse"},
      {"entry_says_no_reason", "entry.other-abi", "warn", "without a reason"},
      {"entry_writes_behind", "entry.older-host", "fail", "it must look at size"},
      {"dies_without_tools", "lifecycle.without", "fail", "ended the process while it lives without tools: "},
      {"refuses_without_tools", "lifecycle.without", "fail", "without tools, which it does not require"},
      {"needs_a_window", "lifecycle.headless", "fail", "in plugin test.modes (create)"},
      {"start_fails", "lifecycle", "fail", "not today"},
      {"start_hangs", "lifecycle", "fail", "had not come to an end after 3 s"},
      {"start_prints_without_end", "lifecycle", "fail", "had not come to an end after 3 s"},
      {"start_ends_the_program", "lifecycle", "fail", "by exit() within start"},
      {"thread_throws", "lifecycle", "fail", "in plugin test.modes (on its own thread)"},
      {"stop_throws", "lifecycle", "warn", "of the end"},
      {"stop_hangs", "lifecycle", "fail", "had not come to an end"},
      {"destroy_dies", "lifecycle", "fail", "in plugin test.modes (destroy)"},
      {"parameter_throws", "parameters", "fail", "of a value"},
      {"parameter_dies_at_the_end", "parameters", "fail", kInvalidAccess},
      {"parameter_without_label", "parameters", "warn", "without a label: age"},
      {"panel_throws", "panels", "fail", "of a panel"},
      {"panel_dies", "panels", "fail", "in plugin test.modes (on_ui of a panel)"},
      {"panel_hangs", "panels", "fail", "had not come to an end"},
      {"panel_ends_no_list", "panels", "warn", "does not end a list"},
      {"panel_dies_of_its_box", "panels", "fail", "(on_ui of a panel)"},
      {"tool_throws", "tools", "fail", "of an event"},
      {"tool_dies_of_the_wheel", "tools", "fail", kInvalidAccess},
      {"tool_dies_in_cancel", "tools", "fail", kInvalidAccess},
      {"tool_hangs", "tools", "fail", "had not come to an end"},
      {"command_dies", "commands", "fail", kInvalidAccess},
      {"reader_dies_of_little", "readers", "fail", kInvalidAccess},
      {"reader_hangs", "readers", "fail", "had not come to an end"},
      {"field_writes_to_positions", "steps", "fail", "writes to positions_m, which it may only read"},
      {"field_writes_to_velocities", "steps", "fail", "writes to velocities_m_s, which it may only read"},
      {"field_writes_to_masses", "steps", "fail", "writes to masses_kg, which it may only read"},
      {"field_writes_beyond_its_forces", "steps", "fail", "beyond the end of forces_N"},
      {"field_rounds_upward", "steps", "fail",
       "apply of a force field has changed the floating-point or locale settings"},
      {"stepped_clears_the_simulation", "steps", "fail", "has removed bodies: there were 1, there are 0"},
      {"stepped_removes_a_body", "steps", "fail", "has removed bodies"},
      {"stepped_resets_the_simulation", "steps", "fail", "has changed the state"},
      {"reader_writes_to_its_file", "readers", "fail", "has written to read-only data"},
      {"writer_writes_to_its_mesh", "writers", "fail", "has written to read-only data"},
      {"simulator_rounds_upward", "simulators", "fail", "it rounds upward"},
      {"simulator_takes_small_structs", "simulators.arguments", "fail",
       "body_info with a c3de_sim_body_info of size 4"},
      {"field_divides_by_zero", "steps", "fail", "inf"},
      {"field_dies_of_little", "steps", "fail", kInvalidAccess},
      {"field_throws", "steps", "fail", "of a field"},
      {"stepped_throws", "steps", "fail", "of a watch"},
      {"writer_dies_of_much", "writers", "fail", kInvalidAccess},
      {"writer_hangs", "writers", "fail", "had not come to an end"},
      {"writer_throws", "writers", "fail", "of a writer"},
      {"writer_puts_nowhere", "writers", "fail", "bytes is null"},
      {"no_label", "classes", "warn", "has no label"},
      {"retain_says_nothing", "classes", "fail", "they must be 2 and 1"},
      {"release_keeps_one", "classes", "fail", "the last release answers 1"},
      {"query_of_object_crashes_on_long_ids", "classes", "fail", kInvalidAccess},
      {"answers_everything", "classes", "fail", "no.such.iface/1"},
      {"claims_every_revision", "classes", "fail", "claims to have revision"},
      {"lists_what_it_does_not_answer", "classes", "fail", "which its class lists"},
      {"answers_null", "classes", "fail", "does not implement test.odd/1"},
      {"another_table_each_time", "classes", "fail", "another table each time"},
      {"fails_at_the_hundredth_object", "classes", "fail", "object 100 of test.modes.Odd"},
      {"makes_null", "classes", "fail", "object 1 of test.modes.Odd"},
      {"retain_is_not_atomic", "classes.shared", "fail", "retain 20000 times each"},
      {"release_is_not_atomic", "classes.shared", "fail", "release what they have retained"},
      {"query_is_for_one_at_a_time", "classes.shared", "fail", "of several threads at once are refused"},
      {"simulator_refuses_bodies", "simulators", "fail", "I do not like this body"},
      {"simulator_fails", "simulators", "fail", "step 8 answers"},
      {"simulator_aborts", "simulators", "fail", "SIGABRT"},
      {"simulator_hangs", "simulators", "fail", "had not come to an end"},
      {"simulator_stands_still", "simulators", "warn", "does not move"},
      {"simulator_is_random", "simulators", "fail", "another state"},
      {"simulator_gives_nan", "simulators", "fail", "not finite"},
      {"simulator_cannot_reset", "simulators", "fail", "reset fails: not now"},
      {"simulator_resets_nearly", "simulators", "fail", "exactly"},
      {"simulator_remembers_beyond_reset", "simulators", "fail", "after a reset lead to another state"},
      {"simulator_hash_is_constant", "simulators", "fail", "stays the same while the surface moves"},
      {"simulator_hash_counts_calls", "simulators", "fail", "is not that of the beginning"},
      {"simulator_ignores_interrupt", "simulators.interrupt", "fail", "answers 0 instead of -12"},
      {"simulator_ends_with_another_status", "simulators.interrupt", "fail", "instead of -12"},
      {"simulator_is_interrupted_half_way", "simulators.interrupt", "fail", "another state than the one before"},
      {"simulator_stays_interrupted", "simulators.interrupt", "fail", "after interrupt(0), step 1 answers"},
      {"simulator_has_no_surface", "simulators", "warn", "no surface"},
      {"state_forgets", "simulators.states", "fail", "are not those after the saved one"},
      {"state_takes_everything", "simulators.states", "fail", "bytes of a state are accepted"},
      {"state_changes_and_refuses", "simulators.states", "fail", "has changed something"},
      {"state_crashes_on_cut_bytes", "simulators.states", "fail", kInvalidAccess},
      {"simulator_takes_everything", "simulators.arguments", "fail", "accepts what it must refuse"},
      {"simulator_crashes_on_null", "simulators.arguments", "fail", kInvalidAccess},
  };
#if !defined(_WIN32)  // where neither memory nor threads are counted, and a plugin contains a C++ library of its own
  modes.push_back({"create_leaks", "lifecycle.repeated", "fail", "bytes are not given back"});
  modes.push_back({"thread_stays", "lifecycle.threads", "fail", "1 of its threads still run"});
  modes.push_back({"panel_changes_the_locale", "panels", "fail", "it writes numbers as in the locale"});
#endif
  {
    const Validated good = validate(testPlugin("modes"));
    INFO(good.output);
    REQUIRE(good.exitCode == 0);
  }
  for (const Mode &one : modes) {
    INFO(one.mode);
    const ScopedEnvironment mode("C3DE_TEST_MODE", one.mode);
    const Validated found =
        validate(testPlugin("modes"), {"--timeout", "3", "--only", "^" + std::string(one.check) + "$"});
    INFO(found.output);
    CHECK(found.exitCode == (one.result == std::string("fail") ? 1 : 0));
    REQUIRE(found.checks.size() == 1);
    CHECK(found.checks[0]["result"] == one.result);
    CHECK_THAT(found.checks[0]["text"].get<std::string>(), Contains(one.says));
  }
}

#if defined(__linux__)
TEST_CASE("what hangs ends with the program that checks it") {
  const ScopedEnvironment mode("C3DE_TEST_MODE", "start_hangs");
  constexpr const char *kSeed = "60221407600000";  // used by no other test
  fs::create_directories(testOutputRoot());
  const fs::path log = fs::path(testOutputRoot()) / "hanging.log";
  auto program =
      c3de::ChildProcess::start({C3DE_VALIDATE, "--only", "^lifecycle$", "--seed", kSeed, testPlugin("modes")}, log);
  REQUIRE(program);
  const auto textOf = [](const fs::path &path) {
    std::ifstream file(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), {});
  };
  const auto children = [&] {  // child processes that have loaded the plugin
    int n = 0;
    for (const auto &entry : fs::directory_iterator("/proc")) {
      const std::string line = textOf(entry.path() / "cmdline");
      if (line.find("--child") != std::string::npos && line.find(kSeed) != std::string::npos &&
          textOf(entry.path() / "maps").find(testPlugin("modes")) != std::string::npos)
        ++n;
    }
    return n;
  };
  const auto until = [&](auto &&done) {
    for (int i = 0; i < 500 && !done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return done();
  };
  CHECK(until([&] { return children() == 1; }));
  program->kill();
  CHECK(until([&] { return children() == 0; }));
}
#endif

TEST_CASE("files that are no plugins are said to be none, and asking wrongly is said") {
  const fs::path folder = fs::path(testOutputRoot()) / "validate";
  fs::create_directories(folder);
  const auto file = folder / ("text" + std::string(c3de::pluginExtension()));
  std::ofstream(file) << "this is no library";
  const Validated text = validate(file.string());
  CHECK(text.exitCode == 1);
  CHECK(text.of("file")["result"] == "fail");
  CHECK(text.of("lifecycle")["result"] == "skip");

  fs::remove(file);
  fs::copy_file(C3DE_HELLO, file);
  fs::resize_file(file, fs::file_size(file) / 2);
  const Validated cut = validate(file.string());
  CHECK(cut.exitCode == 1);
  CHECK(cut.of("file")["result"] == "fail");

  CHECK(validate((folder / "absent.so").string()).exitCode == 1);
  CHECK(validate(C3DE_HELLO, {"--only", "["}).exitCode == 2);
  CHECK(validate(C3DE_HELLO, {"--only", "no such check"}).exitCode == 2);
  CHECK(validate(C3DE_HELLO, {"--sed", "3"}).exitCode == 2);
  const auto none = c3de::runProcess({C3DE_VALIDATE}, 20.0);
  CHECK(none->exitCode == 2);
  const auto list = c3de::runProcess({C3DE_VALIDATE, "--list"}, 20.0);
  CHECK_THAT(list->output, Contains("lifecycle.repeated") && Contains("simulators"));
  // The same seed gives the same run.
  const auto twice = [&](const char *seed) { return validate(C3DE_MAGNET, {"--only", "parameters", "--seed", seed}); };
  CHECK(twice("7").checks[0]["text"] == twice("7").checks[0]["text"]);
}
