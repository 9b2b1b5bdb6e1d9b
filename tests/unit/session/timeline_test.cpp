// SPDX-License-Identifier: Apache-2.0
// A timeline jumps to any position of a recording, with the state that a straight replay has there.
#include "c3de/session/timeline.h"

#include <map>
#include <random>

#include "c3de/session/recorder.h"
#include "c3de/session/session.h"
#include "c3de/session/simulation_state.h"
#include "c3de/session/simulator_access.h"
#include "recording_sample.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using namespace c3de::test;
namespace fs = std::filesystem;

namespace {

struct Simulated {
  RecordingSimulator simulator;
  std::unique_ptr<Session> session;

  explicit Simulated(bool hasWarmStart) {
    SessionOptions without;
    without.searchPlugins = false;
    without.threads = 1;
    session = std::move(*Session::create(without));
    simulator.hasChanges = simulator.hasStates = simulator.hashesState = true;
    simulator.hasWarmStart = hasWarmStart;
    simulator.dt_s = 0.1;
  }
  void adopt(SimulationSource source = {}) {
    REQUIRE(session->adoptForRun(simulator.object(), "test", std::move(source)));
  }
  void step(int n = 1) {
    for (int i = 0; i < n; ++i) {
      REQUIRE(session->simulation()->beginStep());
      REQUIRE(simulator.table()->step(simulator.object()) >= 0);
      session->simulation()->endStep();
    }
  }
  [[nodiscard]] Timeline::Target target() { return {*session, *session->simulation(), session->changes()}; }
  [[nodiscard]] std::uint64_t hash() { return stateHash(simulator.table(), simulator.object()).value(); }
};

/// 60 steps with changes that last, one that holds, a reset, and a state that was stored.
Recording recordedRun(const fs::path &file, bool hasWarmStart) {
  Simulated s(hasWarmStart);
  s.adopt();
  RecordingStart start = recordingStart();
  start.session.state = stateBytes(*s.session, s.simulator.object(), start.simulator).value();
  const auto recorder = Recorder::create(file, start, s.simulator.object()).value();
  s.session->setRecorder(recorder);
  s.step(11);
  s.simulator.change("hold", C3DE_SIM_CHANGE_TRANSIENT);
  s.step(6);
  s.simulator.change("release", C3DE_SIM_CHANGE_TRANSIENT);
  s.step(8);
  s.simulator.change("plate");
  s.step(7);
  (void)stateBytes(*s.session, s.simulator.object(), start.simulator);
  s.step(8);
  recorder->addReset(s.simulator.steps);
  s.simulator.reset();
  s.step(10);
  s.simulator.change("screw");
  s.step(10);
  REQUIRE(recorder->finish());
  return readRecording(file).value();
}

/// Executes the jumps of a timeline as the window does.
class Seeker {
 public:
  Seeker(Recording recording, bool hasWarmStart, TimelineOptions options)
      : hasWarmStart_(hasWarmStart), timeline(std::move(recording), "a.c3dr", {}, options) {}

  void seek(std::uint64_t made) {
    for (int tries = 0; tries < 20; ++tries) {
      const Timeline::Jump jump = timeline.jumpTo(made);
      if (jump.kind == Timeline::JumpKind::rebuild) build(jump.from);
      if (jump.kind == Timeline::JumpKind::restore) {
        ++restores;
        if (!timeline.restore(now->target(), jump.from)) continue;
      }
      Timeline::Limits limits;
      limits.until = made;
      limits.mayTry = true;
      const auto advanced = timeline.advance(now->target(), limits);
      if (!advanced) FAIL(advanced.error().message);
      if (advanced->outcome == Timeline::Outcome::reached) return;
    }
    FAIL("it tries for ever");
  }

  std::unique_ptr<Simulated> now;
  int builds = 0, restores = 0;

 private:
  bool hasWarmStart_;

 public:
  Timeline timeline;

 private:
  void build(const std::shared_ptr<const Keyframe> &from) {
    ++builds;
    now = std::make_unique<Simulated>(hasWarmStart_);
    for (const auto &one : *from->source)
      REQUIRE(applyChange(now->simulator.object(), std::get<SimulationChange>(one), [] { return std::string(); }));
    REQUIRE(goToState(*now->session, now->simulator.object(), recordingStart().simulator, from->state, "state"));
    now->adopt(*from->source);
    timeline.rebuilt(from);
  }
};

/// The state hash at each position, of a replay without keyframes.
std::vector<std::uint64_t> straightHashes(const Recording &recording, bool hasWarmStart) {
  Simulated s(hasWarmStart);
  REQUIRE(goToState(*s.session, s.simulator.object(), recordingStart().simulator, recording.start.session.state, "a"));
  s.adopt();
  Replay replay(recording, "a.c3dr", true);
  std::vector<std::uint64_t> hashes;
  for (;;) {
    REQUIRE(replay.applyDueEvents(*s.session, s.simulator.object(), s.simulator.table(), nullptr));
    REQUIRE(replay.difference().empty());
    hashes.push_back(s.hash());
    if (replay.isAtEnd()) return hashes;
    s.step();
    replay.countStep();
  }
}

constexpr TimelineOptions kOften{std::size_t{1} << 20, 4};

void seekAtRandom(Seeker &seeker, const std::vector<std::uint64_t> &straight) {
  std::mt19937 random(7);
  for (int i = 0; i < 60; ++i) {
    const std::uint64_t made = std::uniform_int_distribution<std::uint64_t>(0, straight.size() - 1)(random);
    seeker.seek(made);
    CAPTURE(i, made);
    CHECK(seeker.timeline.position() == made);
    CHECK(seeker.now->hash() == straight[made]);
  }
  CHECK(seeker.timeline.difference().empty());
}

}  // namespace

TEST_CASE("A seek has the state hash of a straight replay, with extra keyframes") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr", false);
  const std::vector<std::uint64_t> straight = straightHashes(recording, false);
  CHECK(straight.size() == 61);
  Seeker seeker(recording, false, kOften);
  seekAtRandom(seeker, straight);
  const auto &all = seeker.timeline.keyframes().all();
  CHECK(all.size() > 8);
  for (const auto &one : all) {
    const bool isHeld = one->at.made >= 11 && one->at.made < 17;
    CHECK_FALSE(isHeld);
  }
  CHECK(seeker.restores > 5);
}

TEST_CASE("Where storing a state changes the result, only recorded states become keyframes") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr", true);
  const std::vector<std::uint64_t> straight = straightHashes(recording, true);
  Seeker seeker(recording, true, kOften);
  seekAtRandom(seeker, straight);
  seeker.seek(straight.size() - 1);
  const auto &all = seeker.timeline.keyframes().all();
  REQUIRE(all.size() == 1);
  CHECK(all.front()->at.made == 32);
  CHECK_FALSE(all.front()->isExtra);
}

TEST_CASE("A recording that differs is replayed to its end, and the first step that differs is stated") {
  Recording recording = recordedRun(emptyFolder() / "a.c3dr", false);
  int hashes = 0;
  for (RecordedEvent &event : recording.events)
    if (auto *hash = std::get_if<RecordedHash>(&event); hash && ++hashes == 5) hash->hash = 0x123;
  Seeker seeker(recording, false, kOften);
  seeker.seek(30);
  CHECK(seeker.timeline.difference() == "differs from the recording at step 10");
  seeker.seek(60);
  CHECK(seeker.timeline.position() == 60);
  const int builds = seeker.builds;
  seeker.seek(3);
  seeker.seek(58);
  CHECK(seeker.builds <= builds + 2);
}

TEST_CASE("A replay pauses at the limits of its pace") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr", false);
  Seeker seeker(recording, false, {});
  seeker.seek(0);
  Timeline::Limits limits;
  limits.until = 60;
  limits.simulated_s = 0.25;
  const auto advance = [&] { return seeker.timeline.advance(seeker.now->target(), limits).value(); };
  CHECK(advance().outcome == Timeline::Outcome::paused);
  CHECK(seeker.timeline.position() == 3);
  limits.isStopped = [] { return true; };
  CHECK(advance().outcome == Timeline::Outcome::paused);
  CHECK(seeker.timeline.position() == 3);
  limits = {};
  limits.until = 100;
  CHECK(advance().outcome == Timeline::Outcome::reached);
  CHECK(seeker.timeline.isAtEnd());
  CHECK(seeker.timeline.position() == 60);
}

TEST_CASE("The axis of a recording has times and marks across resets") {
  const Recording recording = recordedRun(emptyFolder() / "a.c3dr", false);
  const TimelineAxis axis(recording);
  CHECK(axis.length() == 60);
  CHECK_THAT(axis.timeAt_s(0), WithinAbs(0.0, 1e-12));
  CHECK_THAT(axis.timeAt_s(15), WithinAbs(1.5, 1e-9));
  CHECK_THAT(axis.timeAt_s(40), WithinAbs(4.0, 1e-9));
  CHECK_THAT(axis.timeAt_s(60), WithinAbs(6.0, 1e-9));
  std::vector<std::pair<std::uint64_t, std::string>> marks;
  for (const TimelineMark &mark : axis.marks()) marks.emplace_back(mark.made, mark.text);
  CHECK(marks == std::vector<std::pair<std::uint64_t, std::string>>{
                     {11, "add hold"}, {17, "add release"}, {25, "add plate"}, {40, "reset"}, {50, "add screw"}});
}

TEST_CASE("Keyframes are thinned out evenly where their memory is exceeded") {
  Keyframes keyframes(10 * 100);
  for (std::uint64_t made = 10; made <= 400; made += 10) {
    auto one = std::make_shared<Keyframe>();
    one->at.made = made;
    one->state.assign(100, 'x');
    keyframes.add(std::move(one));
    CHECK(keyframes.bytes() <= 1000);
  }
  CHECK(keyframes.all().size() == 10);
  CHECK(keyframes.all().back()->at.made == 400);
  std::uint64_t before = 0, widest = 0;
  for (const auto &one : keyframes.all()) {
    widest = std::max(widest, one->at.made - before);
    before = one->at.made;
  }
  CHECK(widest <= 80);
  CHECK(keyframes.lastUpTo(5, [](const Keyframe &) { return true; }) == nullptr);
  CHECK(keyframes.lastUpTo(1000, [](const Keyframe &) { return true; })->at.made == 400);
  auto large = std::make_shared<Keyframe>();
  large->state.assign(2000, 'x');
  keyframes.add(std::move(large));
  CHECK(keyframes.all().size() == 10);
}
