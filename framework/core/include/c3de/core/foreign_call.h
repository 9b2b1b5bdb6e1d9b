// SPDX-License-Identifier: Apache-2.0
// Which code from outside is being called, on every thread: so that a call that does not return, and one that ends the
// program, can be named.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include "c3de/abi/base.h"

namespace c3de {

/// How long a call may take before it is said that it hangs.
enum class CallKind : std::uint8_t {
  prompt,  ///< somebody waits for it: a panel, a tool, create
  job,     ///< may go on as long as it says that it does
  step,    ///< the same, on the thread of a simulation
  part     ///< of one that is on another thread; not told
};

/// A call into code from outside, on one thread; rounding and locale are restored after it (environment_faults.h). Any
/// thread. Beyond kMostNested calls within each other, and where there are very many threads, a call is not recorded.
class ForeignCall {
 public:
  static constexpr std::size_t kMostNested = 16;

  /// @param owner, what  live as long as the program: literals or keptName()
  /// @param subject  what the call is about, for those who are told of it; for example a handle
  ForeignCall(const char *owner, const char *what, CallKind kind, std::uint64_t subject = 0) noexcept;
  ~ForeignCall();
  ForeignCall(const ForeignCall &) = delete;
  ForeignCall &operator=(const ForeignCall &) = delete;

  /// Whether this thread is in as many calls as may stand within each other, or has been since it was in none: so that
  /// two callbacks that answer each other twice each come to an end. What is refused for that is said once.
  [[nodiscard]] static bool isTooDeep(const char *owner, const char *what) noexcept;
  /// It has said that it gets on: its time begins again. Any thread while it lasts.
  void noteProgress() const noexcept;

 private:
  std::atomic<std::uint64_t> *serial_ = nullptr;  ///< of its record
};

/// The exception in flight in one line, for messages.
[[nodiscard]] std::string textOfException();
/// The exception in flight as an error in the log.
void logException(const char *owner, const char *what) noexcept;

/// Calls a function of a table from outside, recorded; an exception that leaves it is logged and C3DE_E_EXCEPTION.
template <class F>
c3de_status callForeign(const char *owner, const char *what, CallKind kind, F &&f) noexcept {
  try {
    const ForeignCall call(owner, what, kind);
    if constexpr (std::is_invocable_v<F, const ForeignCall &>)
      return f(call);
    else
      return f();
  } catch (...) {
    logException(owner, what);
    return C3DE_E_EXCEPTION;
  }
}

/// A copy that is never freed, one for each text.
[[nodiscard]] const char *keptName(std::string_view name);

/// A call that takes long, as the watchdog tells it.
struct LongCall {
  std::string owner, what;
  CallKind kind = CallKind::prompt;
  std::uint64_t subject = 0;
  double seconds = 0.0;     ///< since it began or said that it gets on; to about a tenth of the limit
  bool isOver = false;      ///< it has returned, or said that it gets on
  bool isOnMain = false;    ///< on the thread that made the watchdog
  bool isRepeated = false;  ///< it was told before
};

/// Looks from a thread of its own for calls that take long, and tells of each: at the limit, then each time it has
/// taken three times as long, and at the end.
class CallWatchdog {
 public:
  struct Limits {
    std::chrono::milliseconds prompt{2000};
    std::chrono::milliseconds work{10000};  ///< of jobs and steps
  };
  /// @param tell  called on the watchdog's thread
  CallWatchdog(const Limits &limits, std::function<void(const LongCall &)> tell);
  ~CallWatchdog();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// From now on, code from outside that ends the program (exit, quick_exit, on Linux _exit) is named on stderr and in the
/// journal, also on a thread of its own, and the exit code is `code`. On the main thread. exit_group is not seen.
void nameWhoExits(int code);

}  // namespace c3de
