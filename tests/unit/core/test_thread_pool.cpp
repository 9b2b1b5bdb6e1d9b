// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#ifdef __linux__
#include <sys/resource.h>
#endif

#include "c3de/core/thread_pool.h"
#include "support/catch.h"

using c3de::ThreadPool;

namespace {

// Long enough for a thread to be scheduled on a busy machine.
bool comesTrue(const std::function<bool()> &condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

}  // namespace

TEST_CASE("a parallel loop covers every index once, whatever the threads and the grain") {
  for (const unsigned threads : {1u, 2u, 5u})
    for (const std::size_t n : {0u, 1u, 7u, 1000u, 100003u})
      for (const std::size_t grain : {1u, 64u, 100000u}) {
        ThreadPool pool(threads);
        std::vector<std::atomic<int>> seen(n);
        pool.parallelFor(n, grain, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) ++seen[i];
        });
        std::size_t wrong = 0;
        for (const auto &count : seen) wrong += count != 1;
        CHECK(wrong == 0);
      }
}

TEST_CASE("many short loops in a row end, each complete") {
  ThreadPool pool(2);
  std::vector<long> values(512, 0);
  for (int round = 0; round < 5000; ++round)
    pool.parallelFor(values.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++values[i];
    });
  CHECK(std::accumulate(values.begin(), values.end(), 0L) == 512L * 5000L);
}

TEST_CASE("a nested loop runs inline instead of waiting for itself") {
  ThreadPool pool(2);
  std::atomic<int> inner{0};
  pool.parallelFor(8, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      pool.parallelFor(10, 1, [&](std::size_t b, std::size_t e) { inner += static_cast<int>(e - b); });
  });
  CHECK(inner == 80);
}

TEST_CASE("two threads may use one pool at the same time") {
  ThreadPool pool(2);
  std::atomic<long> sum{0};
  const auto use = [&] {
    for (int round = 0; round < 500; ++round)
      pool.parallelFor(100, 4, [&](std::size_t begin, std::size_t end) { sum += static_cast<long>(end - begin); });
  };
  std::thread other(use);
  use();
  other.join();
  CHECK(sum == 2L * 500L * 100L);
}

TEST_CASE("what a thread does not get to is done by the others") {
  ThreadPool pool(2);
  constexpr std::size_t kItems = 1000;
  for (const std::size_t slow : {std::size_t{0}, kItems / 2}) {  // the first item of either thread's own half
    std::atomic<std::size_t> done{0}, slowOnes{0};
    std::atomic<bool> othersDidTheRest{false};
    pool.parallelFor(kItems, 1, [&](std::size_t begin, std::size_t end) {
      if (begin <= slow && slow < end) {
        slowOnes = end - begin;
        othersDidTheRest = comesTrue([&] { return done == kItems - (end - begin); });
      } else {
        done += end - begin;
      }
    });
    CHECK(othersDidTheRest);
    CHECK(done + slowOnes == kItems);
  }
}

TEST_CASE("a worker that has gone to sleep is woken by the next loop") {
  ThreadPool pool(2);
  for (int round = 0; round < 20; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(round % 4));
    std::atomic<int> inside{0}, together{0};
    pool.parallelFor(2, 1, [&](std::size_t begin, std::size_t end) {
      if (end - begin != 1) return;
      ++inside;
      if (comesTrue([&] { return inside == 2; })) ++together;
    });
    REQUIRE(together == 2);
  }
}

TEST_CASE("many more threads than processors end their loops") {
  ThreadPool pool(24);
  std::vector<int> values(4096, 0);
  for (int round = 0; round < 200; ++round)
    pool.parallelFor(values.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++values[i];
    });
  CHECK(std::count(values.begin(), values.end(), 200) == 4096);
}

#ifdef __linux__
TEST_CASE("the threads of a background pool give way, and no other thread does") {
  const auto niceness = [] { return getpriority(PRIO_PROCESS, 0); };  // of the calling thread
  const int before = niceness();
  for (const bool isBackground : {false, true}) {
    ThreadPool pool(2, isBackground);
    std::mutex mutex;
    std::map<std::thread::id, int> found;
    CHECK(comesTrue([&] {
      pool.parallelFor(16, 1, [&](std::size_t, std::size_t) {
        const std::lock_guard lock(mutex);
        found[std::this_thread::get_id()] = niceness();
        std::this_thread::yield();
      });
      return found.size() == 2;
    }));
    for (const auto &[thread, nice] : found)
      CHECK(nice == (isBackground && thread != std::this_thread::get_id() ? std::min(before + 5, 19) : before));
  }
}
#endif
