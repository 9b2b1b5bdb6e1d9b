// SPDX-License-Identifier: Apache-2.0
// The run as seen at a terminal: its progress, and its end at the right time.
#include <cmath>
#include <thread>

#include "c3de/core/platform.h"
#include "c3de/session/progress_line.h"
#include "c3de/session/step_limit.h"
#include "support/catch.h"
#include "support/recording_simulator.h"

using namespace c3de;
using namespace c3de::session;
using c3de::test::RecordingSimulator;
using Clock = std::chrono::steady_clock;

TEST_CASE("Progress of short work is not told, later it is a line now and then, within 0 and 100 %") {
  ErrorStreamCapture capture;
  {
    ProgressLine line(false), silent(true);
    CHECK_FALSE(line.isDue());
    line.update(0.1, "too early");
    std::this_thread::sleep_for(std::chrono::milliseconds(2050));
    CHECK(line.isDue());
    CHECK_FALSE(silent.isDue());
    silent.update(0.5, "silent");
    line.update(1.7, "far");
    CHECK_FALSE(line.isDue());
    line.update(0.5, "too soon");
    std::this_thread::sleep_for(std::chrono::milliseconds(2050));
    line.update(std::nan(""), "unknown");
  }
  CHECK(capture.text() == "c3de: 100 %  far\nc3de:   0 %  unknown\n");
}

TEST_CASE("Steps end at the deadline, and whoever takes the simulator over may go on") {
  RecordingSimulator simulator;
  {
    const StepLimit limit(simulator.object(), simulator.table(), Clock::now());
    for (int i = 0; i < 2000 && simulator.interruptCalls == 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  CHECK(simulator.interrupts == std::vector<std::uint32_t>{1, 0});
}

TEST_CASE("Before the deadline, or without one, no step is ended, and the limit goes at once") {
  RecordingSimulator simulator;
  const Clock::time_point begin = Clock::now();
  { const StepLimit limit(simulator.object(), simulator.table(), begin + std::chrono::hours(1)); }
  { const StepLimit limit(simulator.object(), simulator.table(), std::nullopt); }
  CHECK(simulator.interrupts == std::vector<std::uint32_t>{0, 0});
  CHECK(Clock::now() - begin < std::chrono::seconds(5));
}

TEST_CASE("A simulator that cannot end its steps is not asked to") {
  RecordingSimulator simulator;
  simulator.hasInterrupt = false;
  {
    const StepLimit limit(simulator.object(), simulator.table(), Clock::now());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  CHECK(simulator.interrupts.empty());
}
