// SPDX-License-Identifier: Apache-2.0
// Errors of running plugins, and the verdict on each: refused, named, disabled, while the host continues.
#include <chrono>
#include <thread>

#include "bad_plugins/misbehaves.h"
#include "c3de/core/plugin_call.h"
#include "c3de/core/plugin_table.h"
#include "c3de/registry/text_panel.h"
#include "c3de/scene/simulation.h"
#include "c3de/sdk/object.hpp"
#include "host_fixture.h"
#include "support/recording_simulator.h"

using namespace c3de;
using c3de::test::HostFixture;
using namespace std::chrono_literals;

namespace {

/// A host with short time limits, with the plugin that misbehaves on demand.
class Guarded : public HostFixture {
 public:
  Guarded() {
    services.callLimits = {100ms, 100ms};
    host.reset();
    host = std::make_unique<plugin_host::PluginHost>(services);
    REQUIRE(refusalOf(testPlugin("misbehaves")).empty());
    const auto object = host->createObject(TEST_MISBEHAVES_CLASS);
    REQUIRE(object);
    object_ = *object;
    const auto found = queryObject(object_, TEST_MISBEHAVES_ID, 1);
    REQUIRE(found);
    table_ = static_cast<const test_misbehaves_v0 *>(*found);
  }
  c3de_status run(const std::string &what) {
    (void)host->takeError();
    return table_->run(object_, {what.data(), what.size()});
  }
  /// Lines of the watchdog arrive with a short delay.
  bool soon(const std::string &line) {
    for (int i = 0; i < 200 && linesWith(line).empty(); ++i) std::this_thread::sleep_for(10ms);
    return !linesWith(line).empty();
  }
  void runFramesUntilIdle() {
    for (int i = 0; i < 500 && !jobs.running().empty(); ++i) {
      std::this_thread::sleep_for(5ms);
      mainQueue.runFrame();
    }
    mainQueue.runFrame();
  }
  const registry::Notification *message(const std::string &title) {
    for (const registry::Notification &n : panels.notifications())
      if (n.title.find(title) != std::string::npos) return &n;
    return nullptr;
  }

 private:
  c3de_object *object_ = nullptr;
  const test_misbehaves_v0 *table_ = nullptr;
};

/// A simulator with one body of one point, whose steps exceed every timeout and do not end early.
struct SlowSimulator : c3de::test::RecordingSimulator {
  SlowSimulator() {
    bodies = {c3de::test::pointBody("body", 1)};
    stepCost_us = 400'000;
    hasInterrupt = false;
  }
};

}  // namespace

TEST_CASE("a table that is handed over is checked slot by slot, and the message names table and slot") {
  struct Case {
    const char *what, *text;
  };
  const auto given = GENERATE(Case{"class without create", "registry.add_class: class: create is null"},
                              Case{"panel without on_ui", "panels.add: panel: on_ui is null"},
                              Case{"panel of 48 bytes", "panels.add: panel: its member size is 48"},
                              Case{"tool without activate", "tools.add: tool: activate is null"},
                              Case{"tool without cancel", "tools.add: tool: cancel is null"},
                              Case{"tool without on_event", "tools.add: tool: on_event is null"},
                              Case{"listener without changed", "params.declare: listener: changed is null"},
                              Case{"job without run", "jobs.submit: job: run is null"},
                              Case{"job without done", "jobs.submit: job: done is null"},
                              Case{"step without undo", "history.add: edit: undo is null"},
                              Case{"step without redo", "history.add: edit: redo is null"},
                              Case{"field without apply", "forces.add: field: apply is null"});
  Guarded f;
  INFO(given.what);
  CHECK(f.run(given.what) == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains(given.text));
}

TEST_CASE("an object that cannot be called is refused where its class makes it, with plugin, class and slot") {
  Guarded f;
  REQUIRE(f.run("classes") == C3DE_OK);
  const auto errorOf = [&](const std::string &id) {
    const auto made = f.host->createObject(id);
    return made ? std::string() : made.error().message;
  };
  CHECK(errorOf("test.bad.NoRelease/0") ==
        "create of class test.bad.NoRelease/0 of plugin test.misbehaves: object: release is null, revision 1 has it");
  CHECK_THAT(errorOf("test.bad.TooSmall/0"), Contains("object: its size 16 ends before release"));
  CHECK_THAT(errorOf("test.bad.NoTable/0"), Contains("the object has no table of functions"));
  CHECK_THAT(errorOf("test.bad.NoObject/0"), Contains("the object is null"));
}

TEST_CASE("a simulator without a step is refused before it is run, with the slot") {
  Guarded f;
  REQUIRE(f.run("classes") == C3DE_OK);
  const auto object = f.host->createObject("test.bad.NoStep/0");
  REQUIRE(object);
  CHECK(std::string(f.host->ownerOf(*object)) == "test.misbehaves");
  const auto simulation = scene::Simulation::create(*object);
  REQUIRE_FALSE(simulation);
  CHECK_THAT(simulation.error().message, Contains(C3DE_IFACE_SIMULATOR_ID ": step is null, revision 1 has it"));
}

TEST_CASE("exceptions that leave create, query and release of an object are named") {
  Guarded f;
  REQUIRE(f.run("classes") == C3DE_OK);
  const auto created = f.host->createObject("test.bad.ThrowingCreate/0");
  REQUIRE_FALSE(created);
  CHECK(created.error().message ==
        "an exception left create of class test.bad.ThrowingCreate/0 of plugin "
        "test.misbehaves: thrown in create of a class");
  CHECK(f.run("class that throws, from a plugin") == C3DE_E_EXCEPTION);
  CHECK_THAT(f.host->takeError(), Contains("test.bad.ThrowingCreate/0") && Contains("thrown in create of a class"));

  const auto object = f.host->createObject("test.bad.Throws/0");
  REQUIRE(object);
  const auto table = queryObject(*object, "any/0", 1);
  REQUIRE_FALSE(table);
  CHECK_THAT(table.error().message,
             Contains("query() of the object threw") && Contains("any/0") && Contains("thrown in query"));
  releaseObject(*object);
  CHECK(f.linesWith("an exception left release of an object: thrown in release").size() == 1);
  // The C++ wrappers for plugins are equally careful.
  {
    const auto theirs = sdk::Ref<>::share(*object);
    CHECK(theirs.query<c3de_simulator_v1>() == nullptr);
  }
}

TEST_CASE("a class that creates itself ends at a depth, with its name") {
  Guarded f;
  REQUIRE(f.run("classes") == C3DE_OK);
  const auto made = f.host->createObject("test.bad.Itself/0");
  REQUIRE_FALSE(made);
  CHECK_THAT(made.error().message,
             Contains("class test.bad.Itself/0 of plugin test.misbehaves") && Contains("16 nested plugin calls"));
  CHECK(made.error().message.size() < 300);  // not reported once for each
  REQUIRE(f.host->createObject(TEST_MISBEHAVES_CLASS));
}

TEST_CASE("a thousand classes are made, used and removed") {
  Guarded f;
  CHECK(f.run("1000 classes") == C3DE_OK);
  CHECK(f.host->classes().size() == 1);
}

TEST_CASE("views that cannot be right are refused before anything is made of them") {
  Guarded f;
  CHECK(f.run("2^40 rows") == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains("1099511627776 rows are more than memory can hold"));
  CHECK(f.run("negative stride") == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains("stride -24, accepted: 0 (tight) or at least 24"));
  CHECK(f.run("stride below the row") == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains("stride 16"));
  CHECK(f.run("null with rows") == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains("is null"));
  CHECK(f.run("results over what is read") == C3DE_E_ARG);
  CHECK_THAT(f.host->takeError(), Contains("out: its rows overlap the input rows"));
}

TEST_CASE("a call on the main thread that does not return is named while it lasts, and told with its time after") {
  Guarded f;
  const auto [what, call] = GENERATE(table<std::string, std::string>(
      {{"slow panel", "on_ui of a panel"}, {"slow tool", "on_event of a tool"}, {"slow frame", "a frame callback"}}));
  REQUIRE(f.run(what) == C3DE_OK);
  std::vector<std::string> whileItLasts;
  if (what == "slow panel") (void)registry::TextPanel(nullptr).draw(*f.panels.panels().front());
  if (what == "slow tool") {
    REQUIRE(f.tools.activate(f.tools.tools().front().handle));
    c3de_event event{};
    event.size = sizeof event;
    (void)f.tools.dispatch(event);
  }
  if (what == "slow frame") f.mainQueue.runFrame();
  const std::string name = "plugin test.misbehaves: " + call;
  // 100 ms, then three times as long; the call took 400 ms. The lines were written before it returned.
  CHECK(f.linesWith(name + " has not returned for 0.").size() == 2);
  CHECK(f.linesWith("; the program waits for it").size() == 2);
  CHECK(f.soon(name + " has returned after 0.4 s"));
  f.mainQueue.runFrame();
  const registry::Notification *message = f.message("The window did not respond");
  REQUIRE(message);
  CHECK(message->text == "It waited 0.4 s for a plugin and responds again. The log names the plugin.");
}

TEST_CASE("the calls of a plugin's life that do not return are named, the library by its file") {
  Guarded f;
  CHECK(f.refusalOf(HostFixture::testPlugin("slow_query")).empty());
  CHECK(f.linesWith("plugin slow_query" + std::string(pluginExtension()) + ": c3de_plugin_query has not returned")
            .size() == 2);
  REQUIRE(f.run("classes") == C3DE_OK);
  REQUIRE(f.host->createObject("test.bad.Slow/0"));
  CHECK(f.linesWith("plugin test.misbehaves: create of class test.bad.Slow/0 has not returned").size() == 2);
}

TEST_CASE("a job that says nothing is named, one that says that it gets on is not") {
  Guarded f;
  REQUIRE(f.run("busy job") == C3DE_OK);
  f.runFramesUntilIdle();
  CHECK(f.linesWith("the run of a job").empty());
  REQUIRE(f.run("silent job") == C3DE_OK);
  f.runFramesUntilIdle();
  CHECK(f.linesWith("plugin test.misbehaves: the run of a job has not returned for 0.").size() == 2);
  CHECK(f.linesWith("the program waits").empty());
}

TEST_CASE("the message about a job that hangs lets people wait or cancel it") {
  Guarded f;
  REQUIRE(f.run("job until it is cancelled") == C3DE_OK);
  REQUIRE(f.soon("the run of a job has not returned"));
  f.mainQueue.runFrame();
  const registry::Notification *message = f.message("A job is slow to respond");
  REQUIRE(message);
  REQUIRE(message->choices.size() == 2);
  CHECK(message->choices[0].label == "Cancel the job");
  CHECK(message->choices[1].label == "Wait");
  message->choices[1].act();
  CHECK_FALSE(f.jobs.running().front().cancelling);
  message->choices[0].act();
  CHECK(f.jobs.running().front().cancelling);
  f.runFramesUntilIdle();
  CHECK(f.jobs.running().empty());
}

TEST_CASE("work that shows its own progress is named in the log, without a message") {
  Guarded f;
  std::thread([] {
    (void)callPluginFunction("test.slow", "building a body", CallKind::job, [](const PluginCall &) {
      std::this_thread::sleep_for(400ms);
      return C3DE_OK;
    });
  }).join();
  CHECK(f.soon("plugin test.slow: building a body continued after 0.4 s"));
  f.mainQueue.runFrame();
  CHECK(f.panels.notifications().empty());
}

TEST_CASE("a step that hangs is named, and the message lets people stop the simulation") {
  Guarded f;
  SlowSimulator simulator;
  auto created = scene::Simulation::create(simulator.object(), {}, "test.slow");
  REQUIRE(created);
  std::shared_ptr<scene::Simulation> simulation = std::move(*created);
  const Handle node = f.sceneGraph.add({}, "simulation");
  f.simulations.add(node, "simulation", simulation);
  simulation->transport(C3DE_TRANSPORT_PLAY);
  REQUIRE(f.soon("plugin test.slow: a step of the simulation has not returned for 0."));
  f.mainQueue.runFrame();
  const registry::Notification *message = f.message("The simulation is slow to respond");
  REQUIRE(message);
  REQUIRE(message->choices.size() == 2);
  CHECK(message->choices[0].label == "Stop the simulation");
  CHECK(simulation->state().step_running_s > 0.0);
  message->choices[0].act();
  for (int i = 0; i < 200 && simulation->state().step_running_s > 0.0; ++i) std::this_thread::sleep_for(10ms);
  std::this_thread::sleep_for(50ms);  // another step would have begun
  CHECK(simulation->state().step_running_s == 0.0);
  CHECK(simulation->state().mode == C3DE_SIM_STOPPED);
  f.simulations.remove(node);
}

TEST_CASE("a force field that hangs is named") {
  Guarded f;
  REQUIRE(f.run("slow field") == C3DE_OK);
  SlowSimulator simulator;
  CHECK(f.forces.apply({}, simulator.object(), simulator.table()));
  CHECK(f.linesWith("plugin test.misbehaves: apply of a force field has not returned").size() == 2);
}

TEST_CASE("a simulation watch that fails three times in a row is switched off with one message") {
  Guarded f;
  REQUIRE(f.run("watch that throws") == C3DE_OK);
  const c3de_sim_status status{};
  for (int i = 0; i < 10; ++i) std::thread([&] { f.simulations.stepped({1, 1}, status); }).join();
  CHECK(f.linesWith("thrown after a step").size() == 3);
  CHECK(f.linesWith("a simulation watch is switched off").size() == 1);
  f.mainQueue.runFrame();
  const registry::Notification *message = f.message("a simulation watch of test.misbehaves");
  REQUIRE(message);
  message->choices[0].act();
  f.simulations.stepped({1, 1}, status);
  CHECK(f.linesWith("thrown after a step").size() == 4);
}

TEST_CASE("a panel that fails three times in a row is switched off with one message, and on again by its button") {
  Guarded f;
  REQUIRE(f.run("panel that throws") == C3DE_OK);
  registry::TextPanel text(nullptr);
  std::string shown;
  for (int i = 0; i < 20; ++i) shown = text.draw(*f.panels.panels().front());
  CHECK(f.linesWith("thrown in a panel").size() == 3);
  CHECK(f.linesWith("panel 'Bad\\x1b[31m panel' is switched off, because it failed 3 times in a row").size() == 1);
  CHECK(f.panels.notifications().size() == 1);
  CHECK_THAT(shown, Contains("is switched off") && Contains("Switch on again"));

  REQUIRE(f.run("heal") == C3DE_OK);
  text.press("c3de.switch_on");
  (void)text.draw(*f.panels.panels().front());
  CHECK_THAT(text.draw(*f.panels.panels().front()), Contains("healed"));
  CHECK(text.problems().empty());
}

TEST_CASE("a panel that fails now and then stays on") {
  Guarded f;
  REQUIRE(f.run("panel that throws now and then") == C3DE_OK);
  registry::TextPanel text(nullptr);
  for (int i = 0; i < 12; ++i) (void)text.draw(*f.panels.panels().front());
  CHECK(f.linesWith("thrown now and then").size() == 8);
  CHECK(f.linesWith("switched off").empty());
}

TEST_CASE("a tool, a listener and a frame callback that fail in a row are switched off, and on again by the message") {
  Guarded f;
  REQUIRE(f.run("tool that fails") == C3DE_OK);
  REQUIRE(f.run("listener that throws") == C3DE_OK);
  REQUIRE(f.run("frame that throws") == C3DE_OK);
  const Handle tool = f.tools.tools().front().handle;
  REQUIRE(f.tools.activate(tool));
  c3de_event event{};
  event.size = sizeof event;
  ParameterValue value;
  value.id = "on";
  value.type = C3DE_PARAM_BOOL;
  const Handle set = f.madeBy("params");
  for (int i = 0; i < 10; ++i) {
    (void)f.tools.dispatch(event);
    value.num = i % 2;
    REQUIRE(f.parameters.set(set, value, true));
    f.mainQueue.runFrame();
  }
  CHECK(f.linesWith("on_event of a tool failed: the hand is \\x1b[1mtired").size() == 3);
  CHECK(f.linesWith("thrown in a listener").size() == 3);
  CHECK(f.linesWith("thrown in a frame").size() == 3);
  CHECK(f.linesWith("is switched off").size() == 3);
  REQUIRE(f.panels.notifications().size() == 3);
  CHECK_FALSE(f.tools.activate(tool));
  CHECK_THAT(f.host->takeError(), Contains("tool 'Bad tool' is switched off"));

  const registry::Notification *message = f.message("frame callback of test.misbehaves");
  REQUIRE(message);
  REQUIRE(message->choices.size() == 1);
  CHECK(message->choices.front().label == "Switch on again");
  const auto act = message->choices.front().act;
  act();
  for (int i = 0; i < 10; ++i) f.mainQueue.runFrame();
  CHECK(f.linesWith("thrown in a frame").size() == 6);
  f.host.reset();
  act();  // from an unloaded plugin: nothing
}

TEST_CASE("callbacks that call each other without end are stopped, and said in a few lines") {
  Guarded f;
  REQUIRE(f.run("tool that takes itself up again") == C3DE_OK);
  REQUIRE(f.tools.activate(f.tools.tools().front().handle));
  const auto begin = std::chrono::steady_clock::now();
  (void)f.tools.activate({});
  CHECK(std::chrono::steady_clock::now() - begin < 2s);
  CHECK(
      f.linesWith("plugin test.misbehaves: cancel of a tool is not called, nor is what follows: 16 nested plugin calls")
          .size() == 1);
  CHECK(f.tools.activate(f.tools.tools().front().handle));  // the next external call is executed again
}

TEST_CASE("texts of plugins cannot steer a terminal, and what they tried is seen") {
  Guarded f;
  REQUIRE(f.run("panel with bad texts") == C3DE_OK);
  CHECK(f.panels.panels().front()->title == "Bad\\x1b[31m panel");
  const std::string shown = registry::TextPanel(nullptr).draw(*f.panels.panels().front());
  CHECK_THAT(shown, Contains("red \\x1b[31m") && Contains("bytes: \\xff\\xfe and \\u0085") && Contains("two\nlines"));
  CHECK(f.run("lines with bad texts") == C3DE_E_IO);
  CHECK(f.host->takeError() == "bad \\x1b]0;title\\x07 byte \\xc3");
  CHECK(f.linesWith("bell \\x07, escape \\x1b[2J, back\\x08, byte \\xff, turned \\u202e!").size() == 1);
  REQUIRE(f.run("listener that throws") == C3DE_OK);
  CHECK(f.parameters.find(f.madeBy("params"))->decls.front().label == "On\\x07 and \\u202eoff");
}

TEST_CASE("a hundred thousand lines in the log take less than a second") {
  Guarded f;
  const auto begin = std::chrono::steady_clock::now();
  CHECK(f.run("100000 lines") == C3DE_OK);
  CHECK(std::chrono::steady_clock::now() - begin < 2s);
  CHECK(f.linesWith("again and again").size() == 100000);
}

TEST_CASE("curves of what are no numbers are drawn, as gaps") {
  Guarded f;
  REQUIRE(f.run("curves of no numbers") == C3DE_OK);
  registry::TextPanel text(nullptr);
  (void)text.draw(*f.panels.panels().front());
  REQUIRE(text.find("null"));
  CHECK(text.find("null")->text == "no value");
}

TEST_CASE("a list that a panel does not end ends with the panel") {
  Guarded f;
  REQUIRE(f.run("list without an end") == C3DE_OK);
  registry::TextPanel text(nullptr);
  for (int i = 0; i < 3; ++i) (void)text.draw(*f.panels.panels().front());
  CHECK(text.widgets().size() == 1);
}

TEST_CASE("a plugin that ends the program is named, and the program does not answer that all is well") {
  struct Case {
    const char *plugin, *call;
  };
  const auto given =
      GENERATE(Case{"exits_in_create", "plugin test.exits has ended the program, by exit() within create"},
               Case{"exits_in_panel", "within on_ui of a panel"});
  INFO(given.plugin);
  const auto run = runProcess({C3DE_HOST_OF_ONE, HostFixture::testPlugin(given.plugin).string()}, 10.0);
  REQUIRE(run);
  CHECK(run->exitCode == 4);
  CHECK_THAT(run->errorOutput, Contains(given.call));
  CHECK(run->output.find("came to its end") == std::string::npos);
  const auto good = runProcess({C3DE_HOST_OF_ONE, HostFixture::hello().string()}, 10.0);
  REQUIRE(good);
  CHECK(good->exitCode == 0);
  CHECK_THAT(good->output, Contains("came to its end"));
}

TEST_CASE("the record of a call costs some nanoseconds") {
  const double begin_s = processorTime_s();
  constexpr int kCalls = 1'000'000;
  for (int i = 0; i < kCalls; ++i) const PluginCall call("owner", "what", CallKind::prompt);
  const double each_ns = 1e9 * (processorTime_s() - begin_s) / kCalls;
  INFO(each_ns << " ns");
  CHECK(each_ns < 200.0);
}
