// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "c3de/core/thread_priority.h"

#if defined(__x86_64__) || defined(_M_X64)
#include <emmintrin.h>
#define C3DE_RELAX() _mm_pause()
#else
#define C3DE_RELAX() std::this_thread::yield()
#endif

namespace c3de {
namespace {

// An idle worker polls for the next loop this long before it sleeps: longer than the time between two loops of a step,
// much shorter than a frame. Waking it costs the caller a system call, and the worker is available only some 50 µs
// later.
constexpr auto kPatience = std::chrono::microseconds(100);
constexpr int kPollsPerClockRead = 64;  // polls between two reads of the clock
// Polls of the caller for workers that are still busy before it yields its processor to them; some 10 µs.
constexpr int kCallerPolls = 500;

// Each thread processes its range in this many parts; other threads may take the remaining ones.
constexpr std::size_t kParts = 8;

constexpr std::size_t kCacheLine = 64;

thread_local bool insideBody = false;

// The gate of a loop: its number, whether it can still be joined, and how many workers are in it.
constexpr std::uint64_t kOpen = 1ull << 31;
constexpr std::uint64_t kJoined = kOpen - 1;

std::uint64_t loopNumber(std::uint64_t gate) { return gate >> 32; }

// The remaining part of a loop that belongs to one thread.
struct alignas(kCacheLine) Range {
  std::atomic<std::size_t> next{0};
  std::size_t end = 0;  // written while no worker is inside, like the rest of the loop
};

}  // namespace

struct ThreadPool::Impl {
  explicit Impl(unsigned threads) : ranges(threads) {}

  std::vector<std::thread> workers;
  std::mutex callerMutex;

  // The present loop; written by the caller while no worker is inside, read by workers after they have joined.
  alignas(kCacheLine) const std::function<void(std::size_t, std::size_t)> *body = nullptr;
  std::size_t chunk = 1;
  std::vector<Range> ranges;  // [threads], the caller's first

  // On a separate cache line: idle workers poll it all the time.
  alignas(kCacheLine) std::atomic<std::uint64_t> gate{0};

  alignas(kCacheLine) std::atomic<bool> stopping{false};
  std::atomic<bool> sleeping{false};  // a worker may be sleeping and has not been woken
  std::mutex sleepMutex;
  std::condition_variable wake;

  // First the thread's own range, which is the same part of the data in every loop of that length, then parts that
  // other threads have not reached.
  void work(std::size_t self) {
    insideBody = true;
    const std::size_t threads = ranges.size();
    for (std::size_t i = 0; i < threads; ++i) {
      Range &range = ranges[self + i < threads ? self + i : self + i - threads];
      const std::size_t end = range.end;
      // Reading first avoids a transfer of the cache line when no work remains.
      while (range.next.load(std::memory_order_relaxed) < end) {
        const std::size_t begin = range.next.fetch_add(chunk, std::memory_order_relaxed);
        if (begin >= end) break;
        (*body)(begin, std::min(end, begin + chunk));
      }
    }
    insideBody = false;
  }

  // A late worker finds the gate closed and is not awaited: on a busy machine the caller does all the work itself
  // instead of waiting until the other thread gets a processor.
  bool join(std::uint64_t &seen) {
    std::uint64_t g = gate.load(std::memory_order_acquire);
    while (loopNumber(g) != seen && (g & kOpen) != 0)
      if (gate.compare_exchange_weak(g, g + 1, std::memory_order_acq_rel)) {
        seen = loopNumber(g);
        return true;
      }
    return false;
  }

  // Waits until there is a loop to join. @return false: the pool ends
  bool waitForLoop(std::uint64_t &seen) {
    auto begin = std::chrono::steady_clock::now();
    for (int looks = 1;; ++looks) {
      if (join(seen)) return true;
      if (stopping.load(std::memory_order_relaxed)) return false;
      if (looks % kPollsPerClockRead != 0 || std::chrono::steady_clock::now() - begin < kPatience) {
        C3DE_RELAX();
        continue;
      }
      sleep(seen);
      // A worker that was woken too late for that loop is available for the next one of the step.
      begin = std::chrono::steady_clock::now();
    }
  }

  void sleep(std::uint64_t seen) {
    std::unique_lock lock(sleepMutex);
    // Set before the last check, so that a caller that opens a loop after that check sees a sleeper.
    sleeping.store(true);
    const std::uint64_t g = gate.load();
    if ((loopNumber(g) == seen || (g & kOpen) == 0) && !stopping.load()) wake.wait(lock);
  }

  // Once per sleep: a worker that has been woken and waits for a processor is not woken again by every loop.
  void wakeSleepers() {
    std::lock_guard lock(sleepMutex);
    sleeping.store(false);
    wake.notify_all();
  }

  void workerLoop(std::size_t self) {
    std::uint64_t seen = 0;
    while (waitForLoop(seen)) {
      work(self);
      gate.fetch_sub(1, std::memory_order_acq_rel);
    }
  }

  void layOut(std::size_t n, std::size_t grain) {
    const std::size_t threads = ranges.size();
    // No part is smaller than the grain, and surplus parts stay empty.
    const std::size_t share = std::max(grain, (n + threads - 1) / threads);
    chunk = std::max(grain, (share + kParts - 1) / kParts);
    for (std::size_t i = 0; i < threads; ++i) {
      ranges[i].next.store(std::min(n, i * share), std::memory_order_relaxed);
      ranges[i].end = std::min(n, (i + 1) * share);
    }
  }
};

ThreadPool::ThreadPool(unsigned threads, bool isBackground) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  impl_ = std::make_unique<Impl>(threads);
  for (unsigned i = 1; i < threads; ++i)
    impl_->workers.emplace_back([impl = impl_.get(), i, isBackground] {
      if (isBackground) lowerThreadPriority();
      impl->workerLoop(i);
    });
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard lock(impl_->sleepMutex);
    impl_->stopping = true;
  }
  impl_->wake.notify_all();
  for (std::thread &worker : impl_->workers) worker.join();
}

void ThreadPool::parallelFor(std::size_t n, std::size_t grain,
                             const std::function<void(std::size_t, std::size_t)> &body) {
  if (n == 0) return;
  Impl &impl = *impl_;
  grain = std::max<std::size_t>(1, grain);
  if (insideBody || impl.workers.empty() || n <= grain || !impl.callerMutex.try_lock()) {
    body(0, n);
    return;
  }
  std::lock_guard callerLock(impl.callerMutex, std::adopt_lock);

  impl.body = &body;
  impl.layOut(n, grain);
  const std::uint64_t number = loopNumber(impl.gate.load(std::memory_order_relaxed)) + 1;
  impl.gate.store((number << 32) | kOpen, std::memory_order_seq_cst);
  if (impl.sleeping.load(std::memory_order_seq_cst)) impl.wakeSleepers();
  impl.work(0);
  impl.gate.fetch_and(~kOpen, std::memory_order_acq_rel);
  int looks = 0;
  while ((impl.gate.load(std::memory_order_acquire) & kJoined) != 0) {
    // More threads than processors: yield to the missing worker instead of using up its time slice.
    if (++looks < kCallerPolls) {
      C3DE_RELAX();
    } else {
      std::this_thread::yield();
    }
  }
}

unsigned ThreadPool::threadCount() const { return static_cast<unsigned>(impl_->workers.size()) + 1; }

}  // namespace c3de
