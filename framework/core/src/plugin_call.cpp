// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/plugin_call.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "c3de/core/embedding.h"
#include "c3de/core/environment_faults.h"
#include "c3de/core/log.h"
#include "c3de/core/per_thread.h"
#include "c3de/core/text.h"
#include "fatal_error.h"
#include "plugin_call_environment.h"
#include "plugin_call_site.h"

namespace c3de {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxThreads = 256;

struct Frame {
  std::atomic<std::uint64_t> serial{0};  ///< of this call among those of its thread; 0: being written
  std::atomic<const char *> owner{nullptr}, what{nullptr};
  std::atomic<std::uint64_t> subject{0};
  std::atomic<CallKind> kind{CallKind::prompt};
  std::uint64_t floatControl = 0;  ///< at the start of the call; accessed by its own thread only
};

struct ThreadCalls {
  std::atomic<bool> isOccupied{false};
  std::atomic<std::size_t> depth{0};
  std::atomic<std::thread::id> thread{};
  std::array<Frame, PluginCall::kMaxNested> frames;
  // Accessed by its own thread only:
  const char *lastOwner = nullptr, *lastWhat = nullptr;    ///< of the call that returned last
  const char *otherOwner = nullptr, *otherWhat = nullptr;  ///< of the last call before it with another owner
  std::uint64_t lastSerial = 0;
  bool wasTooDeep = false;
};

// The process has one set of threads, and handlers of exit() have no argument: static.
std::array<ThreadCalls, kMaxThreads> allCalls;
std::atomic<std::size_t> usedCalls{0};

// Without a destructor, so that it can still be read by a handler of exit(), which runs after those of the thread.
thread_local ThreadCalls *ownCalls = nullptr;
thread_local bool hasAsked = false;

/// Releases the slot of a thread at its end.
struct Leave {
  ThreadCalls *calls = nullptr;
  ~Leave() {
    // A thread that ends within a call, by exit(), still has to be reported.
    if (calls && calls->depth.load(std::memory_order_relaxed) == 0) {
      calls->isOccupied.store(false, std::memory_order_release);
      if (ownCalls == calls) ownCalls = nullptr;
    }
  }
};

ThreadCalls *callsOfThread() noexcept {
  if (hasAsked) return ownCalls;
  hasAsked = true;
  (void)perThread<detail::HandlerStack>();
  auto &leave = perThread<Leave>();
  for (std::size_t i = 0; i < allCalls.size(); ++i) {
    bool isOccupied = false;
    if (!allCalls[i].isOccupied.compare_exchange_strong(isOccupied, true, std::memory_order_acq_rel)) continue;
    allCalls[i].thread.store(std::this_thread::get_id(), std::memory_order_relaxed);
    leave.calls = ownCalls = &allCalls[i];
    std::size_t used = usedCalls.load();
    while (used < i + 1 && !usedCalls.compare_exchange_weak(used, i + 1)) {
    }
    break;
  }
  return ownCalls;
}

// Handlers of exit() may use these: never destroyed.
std::mutex &faultsMutex() {
  static auto *const mutex = new std::mutex;
  return *mutex;
}
std::map<std::string, std::string> &faults() {
  static auto *const all = new std::map<std::string, std::string>;
  return *all;
}

std::string localeText(const std::string &was) { return "it writes numbers as in the locale " + displayText(was); }

/// Logs once per owner. @param describe(values...)  describes the change
template <class Describe, class... Values>
void reportChange(const char *owner, const char *what, const Describe &describe, const Values &...values) noexcept {
  try {
    const std::string name = owner != nullptr ? owner : "(unknown)";
    std::string line =
        fmt::format("plugin {}: {} has changed the floating-point or locale settings: {}; they have been restored",
                    name, what != nullptr ? what : "a call", describe(values...));
    {
      const std::lock_guard lock(faultsMutex());
      if (!faults().try_emplace(name, line).second) return;
    }
    log(LogLevel::error, line);
  } catch (...) {  // no memory for the line
  }
}

void restoreLocaleOf(const char *owner, const char *what) noexcept {
  if (isEmbedded()) return;  // there is one locale for the process
  try {
    if (const std::string was = detail::restoreLocale(); !was.empty()) reportChange(owner, what, localeText, was);
  } catch (...) {  // no memory for the text
  }
}

}  // namespace

detail::PluginCallSite detail::pluginCallSiteOfThread() noexcept {
  const ThreadCalls *calls = ownCalls;
  if (!calls) return {};
  const std::size_t depth = std::min<std::size_t>(calls->depth.load(std::memory_order_relaxed), PluginCall::kMaxNested);
  const Frame &frame = calls->frames[depth > 0 ? depth - 1 : 0];
  return {frame.owner.load(), frame.what.load(), depth > 0};
}

detail::PluginCallSite detail::previousCallSiteOfThread(const char *owner) noexcept {
  const ThreadCalls *calls = ownCalls;
  if (!calls) return {};
  if (calls->lastOwner != owner) return {calls->lastOwner, calls->lastWhat, false};
  return {calls->otherOwner, calls->otherWhat, false};
}

PluginCall::PluginCall(const char *owner, const char *what, CallKind kind, std::uint64_t subject) noexcept {
  static const std::uint64_t floatControlOfProgram = detail::floatControl();
  ThreadCalls *calls = callsOfThread();
  if (!calls) return;
  const std::size_t depth = calls->depth.load(std::memory_order_relaxed);
  std::uint64_t floatControl = detail::floatControl();
  // Not every function of a simulator is called through here. A part of a loop may belong to a caller with another
  // floating-point environment.
  if (depth == 0 && kind != CallKind::part) {
    if (floatControl != floatControlOfProgram) {
      detail::setFloatControl(floatControlOfProgram);
      reportChange(calls->lastOwner, calls->lastWhat, detail::floatDifference, floatControl, floatControlOfProgram);
      floatControl = floatControlOfProgram;
    }
    restoreLocaleOf(calls->lastOwner, calls->lastWhat);
  }
  if (depth < kMaxNested) {
    Frame &frame = calls->frames[depth];
    frame.serial.store(0, std::memory_order_relaxed);
    frame.owner.store(owner, std::memory_order_relaxed);
    frame.what.store(what, std::memory_order_relaxed);
    frame.subject.store(subject, std::memory_order_relaxed);
    frame.kind.store(kind, std::memory_order_relaxed);
    frame.serial.store(++calls->lastSerial, std::memory_order_release);
    frame.floatControl = floatControl;
    serial_ = &frame.serial;
  }
  calls->depth.store(depth + 1, std::memory_order_release);
}

PluginCall::~PluginCall() {
  ThreadCalls *calls = ownCalls;
  if (!calls) return;
  const std::size_t depth = calls->depth.load(std::memory_order_relaxed) - 1;
  calls->depth.store(depth, std::memory_order_release);
  if (depth >= kMaxNested) return;
  const Frame &frame = calls->frames[depth];
  const char *owner = frame.owner.load(std::memory_order_relaxed), *what = frame.what.load(std::memory_order_relaxed);
  if (calls->lastOwner != owner) {
    calls->otherOwner = calls->lastOwner;
    calls->otherWhat = calls->lastWhat;
  }
  calls->lastOwner = owner;
  calls->lastWhat = what;
  if (const std::uint64_t now = detail::floatControl(); now != frame.floatControl) {
    detail::setFloatControl(frame.floatControl);
    reportChange(owner, what, detail::floatDifference, now, frame.floatControl);
  }
  if (frame.kind.load(std::memory_order_relaxed) != CallKind::part) restoreLocaleOf(owner, what);
}

std::vector<std::string> environmentFaults() {
  const std::lock_guard lock(faultsMutex());
  std::vector<std::string> all;
  for (const auto &[owner, line] : faults()) all.push_back(line);
  return all;
}

bool PluginCall::hasReachedMaxNesting(const char *owner, const char *what) noexcept {
  ThreadCalls *calls = callsOfThread();
  if (!calls) return false;
  const std::size_t depth = calls->depth.load(std::memory_order_relaxed);
  if (depth == 0) calls->wasTooDeep = false;
  if (depth < kMaxNested && !calls->wasTooDeep) return false;
  if (!std::exchange(calls->wasTooDeep, true)) {
    try {
      log(LogLevel::error, fmt::format("plugin {}: {} is not called, nor is what follows: {} nested plugin calls; "
                                       "do they answer each other without end?",
                                       owner, what, kMaxNested));
    } catch (...) {
    }
  }
  return true;
}

void PluginCall::noteProgress() const noexcept {
  // Far above the initial serial numbers of calls.
  if (serial_) serial_->fetch_add(std::uint64_t{1} << 40, std::memory_order_relaxed);
}

std::string textOfException() {
  try {
    throw;
  } catch (const std::exception &e) {
    return displayText(e.what());
  } catch (...) {
    return "an exception that is not a std::exception";
  }
}

void logException(const char *owner, const char *what) noexcept {
  try {
    log(LogLevel::error, fmt::format("plugin {}: an exception left {}: {}", owner, what, textOfException()));
  } catch (...) {
  }
}

const char *internedName(std::string_view name) {
  static std::mutex mutex;
  static auto *kept = new std::set<std::string, std::less<>>;  // for handlers of exit(): never destroyed
  const std::lock_guard lock(mutex);
  const auto found = kept->find(name);
  return found != kept->end() ? found->c_str() : kept->emplace(name).first->c_str();
}

struct CallWatchdog::Impl {
  /// An observed call.
  struct Seen {
    std::uint64_t serial = 0;
    Clock::time_point since{}, next{};
    LongCall told;  ///< seconds 0: not reported
  };

  Limits limits;
  std::function<void(const LongCall &)> tell;
  const std::thread::id mainThread = std::this_thread::get_id();
  std::vector<std::array<Seen, PluginCall::kMaxNested>> seen;
  std::mutex mutex;
  std::condition_variable wake;
  bool stopping = false;
  std::thread thread;

  void run() {
    const auto shortest = std::min(limits.prompt, limits.work);
    const auto interval =
        std::clamp<std::chrono::milliseconds>(shortest / 10, std::chrono::milliseconds(5), std::chrono::seconds(1));
    Clock::time_point before = Clock::now();
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, interval, [this] { return stopping; })) {
      lock.unlock();
      const Clock::time_point now = Clock::now();
      // The machine was suspended, or is so busy that the time says nothing about the call.
      const Clock::duration lost = now - before > 4 * interval ? now - before - interval : Clock::duration{};
      before = now;
      look(now, lost);
      lock.lock();
    }
  }

  void look(Clock::time_point now, Clock::duration lost) {
    seen.resize(usedCalls.load());
    for (std::size_t t = 0; t < seen.size(); ++t) {
      const ThreadCalls &calls = allCalls[t];
      const std::size_t depth =
          std::min<std::size_t>(calls.depth.load(std::memory_order_acquire), PluginCall::kMaxNested);
      bool isNamed = false;  // the inner call is why the outer one does not return
      for (std::size_t d = seen[t].size(); d-- > 0;) {
        Seen &known = seen[t][d];
        const std::uint64_t serial = d < depth ? calls.frames[d].serial.load(std::memory_order_acquire) : 0;
        if (serial == 0 || serial != known.serial) {
          if (known.told.seconds > 0.0) end(known, now);
          known = {serial, now, now + limitOf(calls.frames[d]), {}};
          continue;
        }
        known.since += lost;
        known.next += lost;
        if (!isNamed && now >= known.next) isNamed = report(known, calls, calls.frames[d], now);
        isNamed = isNamed || known.told.seconds > 0.0;
      }
    }
  }

  [[nodiscard]] Clock::duration limitOf(const Frame &frame) const {
    switch (frame.kind.load(std::memory_order_relaxed)) {
      case CallKind::prompt: return limits.prompt;
      case CallKind::job:
      case CallKind::step: return limits.work;
      case CallKind::part: break;
    }
    return std::chrono::hours(24 * 365);
  }

  /// False: it has just ended.
  bool report(Seen &known, const ThreadCalls &calls, const Frame &frame, Clock::time_point now) {
    LongCall call{frame.owner.load(), frame.what.load(), frame.kind.load(), frame.subject.load()};
    if (frame.serial.load(std::memory_order_acquire) != known.serial) return false;
    call.seconds = std::chrono::duration<double>(now - known.since).count();
    call.isOnMain = calls.thread.load() == mainThread;
    call.isRepeated = known.told.seconds > 0.0;
    known.next = now + 2 * (now - known.since);
    known.told = call;
    tell(call);
    return true;
  }

  void end(Seen &known, Clock::time_point now) {
    known.told.seconds = std::chrono::duration<double>(now - known.since).count();
    known.told.isOver = true;
    tell(known.told);
  }
};

CallWatchdog::CallWatchdog(const Limits &limits, std::function<void(const LongCall &)> tell)
    : impl_(std::make_unique<Impl>()) {
  impl_->limits = limits;
  impl_->tell = std::move(tell);
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

CallWatchdog::~CallWatchdog() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stopping = true;
  }
  impl_->wake.notify_one();
  impl_->thread.join();
}

}  // namespace c3de
