// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <numeric>
#include <thread>
#include <vector>

#include "c3de/core/thread_pool.h"
#include "support/catch.h"

using c3de::ThreadPool;

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
