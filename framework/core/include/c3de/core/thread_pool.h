// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace c3de {

/// Fork-join loops on a fixed set of threads, including the caller. Uses std primitives because the sanitizers support
/// them. A solver step needs a fork-join of a few microseconds, so idle workers spin for some 100 µs before they sleep.
class ThreadPool {
 public:
  /// @param threads      number of threads in parallelFor, including the caller; 0: as many as the machine has
  /// @param isBackground  the threads of the pool yield to interactive ones (thread_priority.h)
  explicit ThreadPool(unsigned threads = 0, bool isBackground = false);
  ~ThreadPool();
  ThreadPool(const ThreadPool &) = delete;
  ThreadPool &operator=(const ThreadPool &) = delete;

  /// Calls body(begin, end) for disjoint ranges of about `grain` that cover [0, n); returns when all are done. Each
  /// thread begins with its own part, the same one in every loop of that length, so that data stay in its cache. Other
  /// threads process the parts it does not reach, so results must not depend on the thread. A call from inside a body,
  /// or while another thread uses the pool, runs inline. Bodies must not throw. Any thread.
  void parallelFor(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)> &body);

  [[nodiscard]] unsigned threadCount() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de
