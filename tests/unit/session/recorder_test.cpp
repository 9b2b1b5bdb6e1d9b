// SPDX-License-Identifier: Apache-2.0
// A recorder writes what happens to a simulation, and a replay repeats it in another simulator.
#include "c3de/session/recorder.h"

#include <chrono>
#include <functional>
#include <thread>

#include "c3de/session/headless_run.h"
#include "c3de/session/replay.h"
#include "c3de/session/session.h"
#include "c3de/session/simulation_state.h"
#include "recording_sample.h"
#include "support/file_size_limit.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

/// A simulator in a session without plugins.
struct Fixture {
  RecordingSimulator simulator;
  std::unique_ptr<Session> session;

  Fixture() {
    SessionOptions without;
    without.searchPlugins = false;
    without.threads = 1;
    session = std::move(*Session::create(without));
    simulator.hasChanges = simulator.hasStates = simulator.hashesState = true;
    simulator.dt_s = 0.1;
  }
  void adoptForRun() { REQUIRE(session->adoptForRun(simulator.object(), "test")); }
  void step(int n = 1) {
    for (int i = 0; i < n; ++i) {
      REQUIRE(session->simulation()->beginStep());
      REQUIRE(simulator.table()->step(simulator.object()) >= 0);
      session->simulation()->endStep();
    }
  }
  std::shared_ptr<Recorder> record(const fs::path &file, RecorderOptions options = {}) {
    auto recorder = Recorder::create(file, recordingStart(), simulator.object(), std::move(options));
    if (!recorder) FAIL(recorder.error().message);
    session->setRecorder(*recorder);
    return *recorder;
  }
  /// A loaded state, as whoever loads one records it.
  void load(Recorder &recorder, const std::string &bytes) {
    const std::uint64_t before = simulator.steps;
    REQUIRE(goToState(*session, simulator.object(), recordingStart().simulator, bytes, "state"));
    recorder.addState(before, bytes);
  }
};

/// Repeats a recording in another simulator.
struct Repeated : Fixture {
  RunOptions options;
  WrittenOutputs outputs;
  std::unique_ptr<HeadlessRun> run;

  Expected<void> repeat(Recording recording, const std::function<void(RunOptions &)> &change = {}) {
    options.quiet = true;
    options.scene = "a.c3dr";
    if (change) change(options);
    Replay replay(std::move(recording), "a.c3dr", true);
    run = std::make_unique<HeadlessRun>(*session, simulator.object(), simulator.table(), options, RunLimits{}, outputs);
    run->repeat(replay);
    return run->run();
  }
};

/// Steps, changes, a reset and a loaded state.
Recording recordedRun(const fs::path &file) {
  Fixture f;
  f.adoptForRun();
  const auto recorder = f.record(file);
  f.simulator.change("plate");
  f.step(3);
  const std::string state = stateBytes(*f.session, f.simulator.object(), recordingStart().simulator).value();
  f.simulator.change("hand", C3DE_SIM_CHANGE_TRANSIENT);
  f.step(2);
  recorder->addReset(f.simulator.steps);
  f.simulator.reset();
  f.step(4);
  f.load(*recorder, state);
  f.simulator.change("screw", C3DE_SIM_CHANGE_RESETS);
  f.step(3);
  REQUIRE(recorder->finish());
  auto read = readRecording(file);
  if (!read) FAIL(read.error().message);
  return std::move(*read);
}

}  // namespace

TEST_CASE("A recorder writes changes, hashes, resets and states in their order") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr");
  CHECK(recording.start == recordingStart());
  CHECK(recording.isComplete());
  std::string order;
  for (const RecordedEvent &event : recording.events) order += "CRSAHE"[event.index()];
  CHECK(order == "CHCHRHHSCHHE");
  std::vector<std::uint64_t> steps;
  for (const RecordedEvent &event : recording.events) steps.push_back(stepsOf(event));
  CHECK(steps == std::vector<std::uint64_t>{0, 2, 3, 4, 5, 1, 3, 4, 3, 1, 3, 3});
  CHECK(recording.lastHash()->made == 12);
  CHECK_THAT(recording.lastHash()->time_s, WithinAbs(0.3, 1e-12));
}

TEST_CASE("A replay has the state hashes of the recording") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr");
  Repeated f;
  const auto repeated = f.repeat(recording);
  if (!repeated) FAIL(repeated.error().message);
  CHECK(f.run->facts().outcome == "done");
  CHECK(f.run->facts().steps == 3);
  CHECK(f.run->facts().stateHash == recording.lastHash()->hash);
  CHECK(f.simulator.changed == std::vector<std::string>{"plate", "screw"});
  CHECK(f.simulator.totalSteps == 12);

  Repeated until;
  REQUIRE(until.repeat(recording, [](RunOptions &options) { options.until_s = 0.2; }));
  CHECK(until.simulator.totalSteps == 2);
  CHECK(until.run->facts().outcome == "done");
}

TEST_CASE("A replay ends at the first state hash that differs, and names its step and both hashes") {
  Recording recording = recordedRun(emptyFolder() / "a.c3dr");
  RecordedHash &hash = std::get<RecordedHash>(recording.events[3]);
  hash.hash = 0x123;
  Repeated f;
  REQUIRE(f.repeat(recording));
  CHECK(f.run->facts().outcome == "differs");
  CHECK_THAT(f.run->facts().failure, Contains("a.c3dr: the replay differs from the recording at step 4, t = 0.4 s") &&
                                         Contains("and 0000000000000123 was recorded"));
  CHECK(f.simulator.totalSteps == 4);
}

TEST_CASE("What cannot be repeated is named with its step") {
  const Recording whole = recordedRun(emptyFolder() / "a.c3dr");
  const auto refusal = [&](const std::function<void(Recording &)> &change, c3de_status ofApply = C3DE_OK) {
    Recording recording = whole;
    change(recording);
    Repeated f;
    if (ofApply < 0) f.simulator.fail("apply", ofApply);
    const auto repeated = f.repeat(std::move(recording));
    REQUIRE_FALSE(repeated.has_value());
    CHECK(repeated.error().code == ErrorCode::input);
    return repeated.error().message;
  };
  CHECK_THAT(refusal([](Recording &) {}, C3DE_E_NOT_FOUND),
             Contains("a.c3dr: at step 0: the change 'add plate' (test.add) cannot be repeated: status -5"));
  CHECK_THAT(refusal([](Recording &one) { std::get<SimulationChange>(one.events[2]).id = "later.kind"; }),
             Contains("a.c3dr: at step 3: the change 'add hand' (later.kind) cannot be repeated"));
  CHECK_THAT(refusal([](Recording &one) { std::get<RecordedState>(one.events[7]).bytes.resize(40); }),
             Contains("a.c3dr: at step 4: the loaded state: the state ends too early"));
  CHECK_THAT(refusal([](Recording &one) { std::get<SimulationChange>(one.events[2]).steps = 1; }),
             Contains("a.c3dr: at step 1: cannot be repeated, as the simulation is at step 2"));
}

TEST_CASE("A replay that cannot reach the next record ends as failed") {
  Repeated f;
  f.simulator.standsStill = true;
  REQUIRE(f.repeat(recordedRun(emptyFolder() / "a.c3dr")));
  CHECK(f.run->facts().outcome == "failed");
  CHECK_THAT(f.run->facts().failure, Contains("ends at step 0, and the recording has more at step 2"));
}

TEST_CASE("A replay needs the plugin and version of the recording") {
  const Replay replay({recordingStart(), {}}, "a.c3dr", true);
  CHECK(replay.checkSimulator(recordingStart().simulator));
  const auto other = replay.checkSimulator({"a.test.Recording/1", "", "test.recording", "2.0.0"});
  REQUIRE_FALSE(other.has_value());
  CHECK(other.error().code == ErrorCode::plugin);
  CHECK(other.error().message == "a.c3dr: was recorded with test.recording 1.2.3; loaded is test.recording 2.0.0");
}

TEST_CASE("Resets of a simulation with a thread are recorded, and a new simulation is not") {
  const fs::path file = emptyFolder() / "a.c3dr";
  RecordingSimulator next;
  Fixture f;
  REQUIRE(f.session->adopt(f.simulator.object(), "test"));
  scene::Simulation *simulation = f.session->simulation();
  std::shared_ptr<Recorder> recorder;
  simulation->call([&] { recorder = f.record(file); });
  CHECK(f.session->recorders() == std::vector{recorder});
  for (int i = 0; i < 3; ++i) simulation->transport(C3DE_TRANSPORT_STEP);
  simulation->call([] {});  // a reset interrupts a step
  simulation->transport(C3DE_TRANSPORT_RESET);
  simulation->transport(C3DE_TRANSPORT_STEP);
  simulation->call([] {});
  REQUIRE(f.session->adopt(next.object(), "next"));
  CHECK(f.session->recorders().empty());
  REQUIRE(recorder->finish());
  const auto read = readRecording(file);
  REQUIRE(read.has_value());
  REQUIRE(read->events.size() == 4);
  CHECK(read->events[1] == RecordedEvent(RecordedReset{3}));
  CHECK(stepsOf(read->events[2]) == 1);
  CHECK(read->lastHash()->made == 4);
}

TEST_CASE("What was recorded is on the disk within a second, without an end") {
  const fs::path file = emptyFolder() / "a.c3dr";
  Fixture f;
  f.adoptForRun();
  const auto recorder = f.record(file);
  f.simulator.change("plate");
  f.step(2);
  for (int i = 0; i < 100; ++i) {
    if (readRecording(file).value().events.size() == 2) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const auto read = readRecording(file);
  CHECK(read->events.size() == 2);
  CHECK(read->whyIncomplete() == "ends early, after step 2");
}

TEST_CASE("A recording that cannot be written ends once with the reason, and the simulation continues") {
  const fs::path folder = emptyFolder();
  Fixture f;
  f.adoptForRun();
  const auto nowhere = Recorder::create(folder / "none" / "a.c3dr", recordingStart(), f.simulator.object());
  REQUIRE_FALSE(nowhere.has_value());
  CHECK_THAT(nowhere.error().message, Contains("there is no folder"));

  std::vector<std::string> failures;
  RecorderOptions options;
  options.queueBytes = 1000;
  options.onFailure = [&](const Error &error) { failures.push_back(error.message); };
  const auto recorder = f.record(folder / "a.c3dr", std::move(options));
  for (int i = 0; i < 3; ++i) f.simulator.change(std::string(2000, 'x'));
  f.step(3);
  const auto finished = recorder->finish();
  REQUIRE_FALSE(finished.has_value());
  CHECK(recorder->hasFailed());
  CHECK(finished.error().code == ErrorCode::output);
  CHECK_THAT(finished.error().message, Contains("a.c3dr: the recording ends: ") && Contains("bytes wait for the disk"));
  REQUIRE(failures.size() == 1);
  CHECK(failures.front() == finished.error().message);
  // What was accepted before is readable.
  const auto read = readRecording(folder / "a.c3dr");
  REQUIRE(read.has_value());
  CHECK_FALSE(read->events.empty());
  CHECK_FALSE(read->isComplete());
}

TEST_CASE("A recording on a full disk ends with its last complete record") {
  const fs::path file = emptyFolder() / "a.c3dr";
  Fixture f;
  f.adoptForRun();
  const auto recorder = f.record(file);
  {
    const FileSizeLimit limit(8192);
    if (!limit.isSet()) return skip("the size of files cannot be limited");
    f.simulator.change(std::string(20'000, 'x'));
    const auto finished = recorder->finish();
    REQUIRE_FALSE(finished.has_value());
    CHECK_THAT(finished.error().message, Contains("a.c3dr: could not be written: File too large"));
  }
  const auto read = readRecording(file);
  REQUIRE(read.has_value());
  CHECK(read->events.empty());
}
