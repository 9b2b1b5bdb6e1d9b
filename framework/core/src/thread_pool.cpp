// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#if defined(__x86_64__) || defined(_M_X64)
#include <emmintrin.h>
#define C3DE_RELAX() _mm_pause()
#else
#define C3DE_RELAX() std::this_thread::yield()
#endif

namespace c3de {
namespace {

// Some 20 to 50 µs on today's machines: longer than the gap between the loops of a step, shorter than a frame.
constexpr int kSpins = 500;

thread_local bool insideBody = false;

// The gate of a loop: its number, whether it can still be joined, and how many workers are in it.
constexpr std::uint64_t kOpen = 1ull << 31;
constexpr std::uint64_t kJoined = kOpen - 1;

std::uint64_t loopNumber(std::uint64_t gate) { return gate >> 32; }

}  // namespace

struct ThreadPool::Impl {
  std::vector<std::thread> workers;
  std::mutex callerMutex;

  // The present loop; written by the caller while nobody is inside, read by workers after they have joined.
  const std::function<void(std::size_t, std::size_t)> *body = nullptr;
  std::size_t n = 0;
  std::size_t chunk = 1;
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> gate{0};
  std::atomic<bool> stopping{false};

  std::mutex sleepMutex;
  std::condition_variable wake;
  std::atomic<unsigned> sleeping{0};

  void work() {
    insideBody = true;
    for (;;) {
      const std::size_t begin = next.fetch_add(chunk, std::memory_order_relaxed);
      if (begin >= n) break;
      (*body)(begin, std::min(n, begin + chunk));
    }
    insideBody = false;
  }

  // A worker that comes late finds the gate closed and is not waited for: on a busy machine the caller does all the work
  // itself instead of standing still until the other thread is given a processor.
  bool join(std::uint64_t &seen) {
    std::uint64_t g = gate.load(std::memory_order_acquire);
    while (loopNumber(g) != seen && (g & kOpen) != 0)
      if (gate.compare_exchange_weak(g, g + 1, std::memory_order_acq_rel)) {
        seen = loopNumber(g);
        return true;
      }
    return false;
  }

  void workerLoop() {
    std::uint64_t seen = 0;
    for (;;) {
      int spins = 0;
      while (!join(seen)) {
        if (stopping.load(std::memory_order_relaxed)) return;
        if (++spins < kSpins) {
          C3DE_RELAX();
          continue;
        }
        std::unique_lock lock(sleepMutex);
        sleeping.fetch_add(1);
        wake.wait(lock, [&] {
          const std::uint64_t g = gate.load();
          return (loopNumber(g) != seen && (g & kOpen) != 0) || stopping.load();
        });
        sleeping.fetch_sub(1);
      }
      work();
      gate.fetch_sub(1, std::memory_order_acq_rel);
    }
  }
};

ThreadPool::ThreadPool(unsigned threads) : impl_(std::make_unique<Impl>()) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < threads; ++i) impl_->workers.emplace_back([impl = impl_.get()] { impl->workerLoop(); });
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

  // Four ranges per thread even out uneven work without many atomics.
  const std::size_t parts = 4 * (impl.workers.size() + 1);
  impl.body = &body;
  impl.n = n;
  impl.chunk = std::max(grain, (n + parts - 1) / parts);
  impl.next.store(0, std::memory_order_relaxed);
  const std::uint64_t number = loopNumber(impl.gate.load(std::memory_order_relaxed)) + 1;
  impl.gate.store((number << 32) | kOpen, std::memory_order_seq_cst);
  if (impl.sleeping.load(std::memory_order_seq_cst) > 0) {
    std::lock_guard lock(impl.sleepMutex);
    impl.wake.notify_all();
  }
  impl.work();
  impl.gate.fetch_and(~kOpen, std::memory_order_acq_rel);
  int spins = 0;
  while ((impl.gate.load(std::memory_order_acquire) & kJoined) != 0) {
    // More threads than processors: give the missing worker room instead of burning its time slice.
    if (++spins < kSpins) {
      C3DE_RELAX();
    } else {
      std::this_thread::yield();
    }
  }
}

unsigned ThreadPool::threadCount() const { return static_cast<unsigned>(impl_->workers.size()) + 1; }

}  // namespace c3de
