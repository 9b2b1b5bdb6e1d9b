// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <thread>

#include "c3de/core/background_jobs.h"
#include "c3de/core/main_queue.h"
#include "support/catch.h"

using namespace c3de;

namespace {

/// Runs frames until the condition holds; false after 5 s.
template <class F>
bool framesUntil(MainQueue &queue, F &&condition) {
  for (int i = 0; i < 5000; ++i) {
    queue.runFrame();
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace

TEST_CASE("a job hands its result back on the main thread") {
  MainQueue queue;
  BackgroundJobs jobs(queue);
  const auto mainThread = std::this_thread::get_id();
  std::thread::id ranOn, doneOn;
  bool done = false;
  jobs.submit(
      "test", "work",
      [&](const ProgressFn &progress) -> Expected<void> {
        ranOn = std::this_thread::get_id();
        if (!progress(0.5, "half")) return fail(ErrorCode::cancelled, "cancelled");
        return {};
      },
      [&](const Expected<void> &result) {
        doneOn = std::this_thread::get_id();
        done = result.has_value();
      });
  REQUIRE(framesUntil(queue, [&] { return done; }));
  CHECK(ranOn != mainThread);
  CHECK(doneOn == mainThread);
  CHECK(jobs.running().empty());
}

TEST_CASE("a cancelled job stops and says so") {
  MainQueue queue;
  BackgroundJobs jobs(queue);
  bool cancelled = false;
  const Handle job = jobs.submit(
      "test", "endless",
      [](const ProgressFn &progress) -> Expected<void> {
        while (progress(-1.0, "going on")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return fail(ErrorCode::cancelled, "cancelled");
      },
      [&](const Expected<void> &result) { cancelled = !result && result.error().code == ErrorCode::cancelled; });
  CHECK(jobs.running().size() == 1);
  CHECK(jobs.cancel(job));
  REQUIRE(framesUntil(queue, [&] { return cancelled; }));
  CHECK_FALSE(jobs.cancel(job));
}

TEST_CASE("the end of the program ends its jobs") {
  MainQueue queue;
  int done = 0;
  {
    BackgroundJobs jobs(queue);
    for (int i = 0; i < 3; ++i)
      jobs.submit(
          "test", "endless",
          [](const ProgressFn &progress) -> Expected<void> {
            while (progress(-1.0, "")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            return fail(ErrorCode::cancelled, "cancelled");
          },
          [&](const Expected<void> &) { ++done; });
  }
  CHECK(done == 3);
  queue.runFrame();  // their posted functions have no receiver and do no harm
}

TEST_CASE("frame callbacks run once per frame until they are removed, by handle or by owner") {
  MainQueue queue;
  int a = 0, b = 0;
  const Handle first = queue.addFrameCallback("one", [&] { ++a; });
  queue.addFrameCallback("two", [&] { ++b; });
  queue.runFrame();
  queue.removeFrameCallback(first);
  queue.runFrame();
  queue.removeOwnedBy("two");
  queue.runFrame();
  CHECK(a == 1);
  CHECK(b == 2);
}

TEST_CASE("a function may be posted from any thread and runs once, waking the window") {
  MainQueue queue;
  std::atomic<int> woken{0};
  queue.setWaker([&] { ++woken; });
  int ran = 0;
  std::thread([&] { queue.post([&] { ++ran; }); }).join();
  CHECK(woken == 1);
  queue.runFrame();
  queue.runFrame();
  CHECK(ran == 1);
}

TEST_CASE("A job that is asked for while the jobs end is not started") {
  c3de::MainQueue queue;
  std::atomic<bool> hasRun{false};
  c3de::Handle second{1, 1};
  {
    c3de::BackgroundJobs jobs(queue);
    jobs.submit(
        "test", "first", [](const c3de::ProgressFn &) -> c3de::Expected<void> { return {}; },
        [&](const c3de::Expected<void> &) {
          second = jobs.submit("test", "second",
                               [&](const c3de::ProgressFn &) -> c3de::Expected<void> {
                                 hasRun = true;
                                 return {};
                               },
                               {});
        });
  }
  CHECK(second.isNull());
  CHECK_FALSE(hasRun);
}
