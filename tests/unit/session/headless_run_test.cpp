// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/headless_run.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
namespace fs = std::filesystem;
using c3de::test::cubeBody;
using c3de::test::RecordingSimulator;

namespace {

/// A run of the stand-in, without plugins.
struct Fixture {
  RecordingSimulator simulator;
  RunOptions options;
  RunLimits limits;
  WrittenOutputs outputs;
  std::unique_ptr<Session> session;
  std::unique_ptr<HeadlessRun> made;

  Fixture() {
    SessionOptions without;
    without.searchPlugins = false;
    without.threads = 1;
    session = std::move(*Session::create(without));
    options.quiet = true;
    simulator.dt_s = 0.1;
    simulator.probes = {{"tip", {1, 2, 3}}};
  }
  Expected<void> run() {
    made = std::make_unique<HeadlessRun>(*session, simulator.object(), simulator.table(), options, limits, outputs);
    return made->run();
  }
  const RunFacts &facts() { return made->facts(); }
};

std::vector<std::string> linesOf(const fs::path &file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::size_t framesOf(const fs::path &list) {
  const auto lines = linesOf(list);
  return static_cast<std::size_t>(std::count_if(
      lines.begin(), lines.end(), [](const std::string &line) { return line.find("skin_") != std::string::npos; }));
}

}  // namespace

TEST_CASE("A run ends after the steps that were asked for, and its facts are the simulator's") {
  Fixture f;
  f.options.steps = 3;
  f.options.seed = 11;
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "done");
  CHECK(f.facts().failure.empty());
  CHECK(f.facts().steps == 3);
  CHECK_THAT(f.facts().time_s, WithinAbs(0.3, 1e-12));
  CHECK(f.facts().dt_s == 0.1);
  CHECK(f.facts().stateHash == 0xabcdu);
  CHECK(f.facts().threads == 1);
  CHECK(f.facts().seed == 11u);
  CHECK_FALSE(f.facts().isLoadStepped);
  CHECK(f.outputs.areComplete());
}

TEST_CASE("A run ends at its time, of which many steps may miss a hair, and after a second by itself") {
  Fixture f;
  f.simulator.dt_s = 0.3;
  f.options.until_s = 0.9;  // three steps of 0.3 s are 0.8999999999999999 s
  REQUIRE(f.run());
  CHECK(f.facts().steps == 3);
  Fixture byItself;
  byItself.simulator.dt_s = 0.25;
  REQUIRE(byItself.run());
  CHECK(byItself.facts().steps == 4);
}

TEST_CASE("A quasi-static solution goes on until the simulator says that it is finished") {
  Fixture f;
  f.simulator.finishesAtStep = 5;
  REQUIRE(f.run());
  CHECK(f.facts().isLoadStepped);
  CHECK(f.facts().outcome == "done");
  CHECK(f.facts().steps == 5);
}

TEST_CASE("A step that fails ends the run, and the place and the reason are told") {
  Fixture f;
  f.simulator.fail("step", C3DE_E_DIVERGED);
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "diverged");
  CHECK(f.facts().failure == "step 1 at 0 s failed: status -14");
  Fixture load;
  load.simulator.fail("step", C3DE_E_STATE);
  load.simulator.finishesAtStep = 5;
  REQUIRE(load.run());
  CHECK(load.facts().outcome == "failed");
  CHECK(load.facts().failure == "load step 1 failed: status -7");
  // Cancelled, although neither a time limit nor a signal has ended it.
  Fixture cancelled;
  cancelled.simulator.fail("step", C3DE_E_CANCELLED);
  REQUIRE(cancelled.run());
  CHECK(cancelled.facts().failure == "step 1 at 0 s failed: status -12");
}

TEST_CASE("A simulator whose steps change nothing does not keep a run going for ever") {
  Fixture f;
  f.simulator.standsStill = true;
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "failed");
  CHECK_THAT(f.facts().failure, Contains("neither step count nor time has advanced"));
}

TEST_CASE("Bodies that stopped on the way make a run that has diverged") {
  Fixture f;
  f.options.steps = 2;
  f.simulator.stopped = 2;
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "diverged");
  CHECK_THAT(f.facts().failure, Contains("2 bodies stopped early"));
  Fixture one;
  one.options.steps = 2;
  one.simulator.stopped = 1;
  REQUIRE(one.run());
  CHECK_THAT(one.facts().failure, Contains("1 body stopped early"));
}

TEST_CASE("A run that reaches its time limit says how far it has come") {
  Fixture f;
  f.options.timeLimit_s = 5.0;
  f.limits.deadline = std::chrono::steady_clock::now();
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "time_limit");
  CHECK(f.facts().failure == "the time limit of 5 s was reached at 0 s");
  CHECK(f.facts().steps == 0);
}

TEST_CASE("Probes are sampled as often as was asked, and at the end whatever brought it about") {
  Fixture f;
  f.options.steps = 5;
  f.options.probes = testOutputFolder() / "probes.csv";
  f.options.probesEvery = 2;
  REQUIRE(f.run());
  const auto lines = linesOf(f.options.probes);
  REQUIRE(lines.size() == 5);  // the header, steps 0, 2, 4 and 5
  CHECK_THAT(lines[0], Contains("tip.x [m]"));
  CHECK(lines[1] == "0,1,2,3,0,0,0");
  CHECK(lines[4] == "0.5,1,2,3,0,0,0");
  CHECK(f.outputs.written() == f.options.probes.string());
}

TEST_CASE("Probes that cannot be written are told, and the run goes on without them") {
  Fixture f;
  f.options.steps = 2;
  f.options.probes = testOutputFolder() / "nowhere" / "probes.csv";
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "done");
  CHECK(f.facts().steps == 2);
  CHECK_FALSE(f.outputs.areComplete());
  CHECK_THAT(f.outputs.error().message, Contains("probes.csv; written: nothing"));
}

TEST_CASE("Frames are exported at their times and at the end") {
  Fixture f;
  f.simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {0, 0, 0})};
  f.simulator.bodies[0].points = 1;
  f.simulator.bodies[0].inside = {{"position", "m", {0, 0, 0}}, {"reference_position", "m", {0, 0, 0}}};
  f.options.steps = 5;
  f.options.exportList = testOutputFolder() / "run.pvd";
  f.options.exportEvery_s = 0.2;
  REQUIRE(f.run());
  CHECK(framesOf(f.options.exportList) == 4);  // 0, 0.2, 0.4 and 0.5 s
  CHECK(f.outputs.written() == f.options.exportList.string());
  // Load steps have no time: each is a frame.
  Fixture load;
  load.simulator.bodies = f.simulator.bodies;
  load.simulator.finishesAtStep = 3;
  load.options.exportList = testOutputFolder() / "load.pvd";
  REQUIRE(load.run());
  CHECK(framesOf(load.options.exportList) == 4);
}

TEST_CASE("An export that fails on the way is told, and the run goes on without it") {
  Fixture f;
  f.simulator.bodies = {cubeBody(0.1, {0, 0, 0}, {0, 0, 0})};
  f.simulator.fail("surface", C3DE_E_INTERNAL);
  f.options.steps = 2;
  f.options.exportList = testOutputFolder() / "run.pvd";
  REQUIRE(f.run());
  CHECK(f.facts().outcome == "done");
  CHECK(f.facts().steps == 2);
  CHECK_FALSE(f.outputs.areComplete());
  CHECK(f.outputs.error().code == ErrorCode::plugin);
}

TEST_CASE("A simulator that does not say its status, its probes or its hash ends the run with an error") {
  const std::pair<const char *, const char *> refusals[] = {{"status", "does not say its status (-17)"},
                                                            {"enum_probes", "does not say its probes (status -17)"},
                                                            {"state_hash", "the simulator gives no state hash"}};
  for (const auto &[function, message] : refusals) {
    Fixture f;
    f.options.steps = 1;
    f.options.probes = testOutputFolder() / "probes.csv";
    f.simulator.fail(function, C3DE_E_INTERNAL);
    const auto run = f.run();
    REQUIRE_FALSE(run);
    CHECK(run.error().code == ErrorCode::plugin);
    CHECK_THAT(run.error().message, Contains(message));
  }
}
