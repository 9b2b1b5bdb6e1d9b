// SPDX-License-Identifier: Apache-2.0
#include "pace.h"
#include "support/catch.h"

using namespace std::chrono_literals;
using c3de::scene::Clock;
using c3de::scene::Meter;
using c3de::scene::Pace;

TEST_CASE("A step is due when the wall clock has come as far as the step's end") {
  Pace pace;
  const Clock::time_point begin{1000s};
  pace.start(begin, 5.0);
  CHECK(pace.dueTime(5.010, 1.0, begin) == begin + 10ms);
  CHECK(pace.dueTime(5.010, 0.5, begin) == begin + 20ms);
  CHECK(pace.dueTime(5.010, 8.0, begin) == begin + 1250us);
}

TEST_CASE("A little lag is made up for, more than that is given up") {
  Pace pace;
  const Clock::time_point begin{1000s};
  pace.start(begin, 0.0);
  // 30 ms late: the next step is still due by the old clock.
  CHECK(pace.dueTime(0.010, 1.0, begin + 40ms) == begin + 10ms);
  CHECK(pace.dueTime(0.020, 1.0, begin + 40ms) == begin + 20ms);
  // Ten seconds late: at most 50 ms are caught up.
  const Clock::time_point late = begin + 10s;
  CHECK(pace.dueTime(0.030, 1.0, late) == late - 50ms);
  CHECK(pace.dueTime(0.130, 1.0, late) == late + 50ms);
}

TEST_CASE("The meter measures simulated time against the wall over the last second") {
  Meter meter;
  CHECK(meter.rates().realTimeFactor() == 0.0);
  Clock::time_point now{1000s};
  // Half real time for 2 s, then twice real time for 1.5 s: the window no longer contains the beginning.
  for (int i = 0; i < 200; ++i) meter.add(now += 10ms, 0.008, 0.005);
  CHECK_THAT(meter.rates().realTimeFactor(), WithinRel(0.5, 0.02));
  CHECK_THAT(meter.rates().meanStep_s, WithinRel(0.008, 1e-9));
  for (int i = 0; i < 150; ++i) meter.add(now += 10ms, 0.002, 0.020);
  CHECK_THAT(meter.rates().realTimeFactor(), WithinRel(2.0, 0.02));
  CHECK_THAT(meter.rates().meanStep_s, WithinRel(0.002, 1e-9));
}

TEST_CASE("Time that was spent paused does not count") {
  Meter meter;
  Clock::time_point now{1000s};
  for (int i = 0; i < 20; ++i) meter.add(now += 10ms, 0.010, 0.010);
  meter.pause();
  now += 60s;
  for (int i = 0; i < 20; ++i) meter.add(now += 10ms, 0.010, 0.010);
  CHECK_THAT(meter.rates().realTimeFactor(), WithinRel(1.0, 1e-6));
  meter.clear();
  CHECK(meter.rates().realTimeFactor() == 0.0);
  CHECK(meter.rates().meanStep_s == 0.0);
}

TEST_CASE("While a step is overdue the rate falls, and after a second without an end it is none") {
  Meter meter;
  Clock::time_point now{1000s};
  for (int i = 0; i < 100; ++i) meter.add(now += 20ms, 0.020, 0.040);
  const Meter::Rates rates = meter.rates();
  CHECK(rates.realTimeFactor(0.015) == rates.realTimeFactor());  // a step as long as those before it changes nothing
  double before = rates.realTimeFactor();
  for (const double running_s : {0.1, 0.3, 0.6, 0.9}) {
    const double later = rates.realTimeFactor(running_s);
    CHECK(later < before);
    CHECK(later > 0.0);
    before = later;
  }
  CHECK(rates.realTimeFactor(1.1) == 0.0);
  CHECK(rates.step_s(0.015) == rates.meanStep_s);
  CHECK(rates.step_s(4.2) == 4.2);
}
