// SPDX-License-Identifier: Apache-2.0
// Records the plugin code being called on every thread, to identify calls that do not return or that terminate the
// program.
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

/// How long a call may take before it is reported as hanging.
enum class CallKind : std::uint8_t {
  prompt,  ///< a caller waits for it: a panel, a tool, create
  job,     ///< may continue as long as it reports progress
  step,    ///< same, on the thread of a simulation
  part     ///< of a call that is on another thread; not reported
};

/// A call of plugin code on one thread; rounding mode and locale are restored after it (environment_faults.h). Any
/// thread. Calls nested deeper than kMaxNested, or with very many threads, are not recorded.
class PluginCall {
 public:
  static constexpr std::size_t kMaxNested = 16;

  /// @param owner, what  must outlive the program's run: literals or internedName()
  /// @param subject  the subject of the call for reports; for example a handle
  PluginCall(const char *owner, const char *what, CallKind kind, std::uint64_t subject = 0) noexcept;
  ~PluginCall();
  PluginCall(const PluginCall &) = delete;
  PluginCall &operator=(const PluginCall &) = delete;

  /// Whether this thread has reached the maximum nesting depth, or has since its outermost call began. Two callbacks
  /// that call each other twice each thus terminate. The first refusal is logged.
  [[nodiscard]] static bool hasReachedMaxNesting(const char *owner, const char *what) noexcept;
  /// The call has reported progress: its time restarts. Any thread during the call.
  void noteProgress() const noexcept;

 private:
  std::atomic<std::uint64_t> *serial_ = nullptr;  ///< of its record
};

/// The exception in flight in one line, for messages.
[[nodiscard]] std::string textOfException();
/// Logs the exception in flight as an error.
void logException(const char *owner, const char *what) noexcept;

/// Calls and records a function of a plugin's table. An exception from it is logged and returned as C3DE_E_EXCEPTION.
template <class F>
c3de_status callPluginFunction(const char *owner, const char *what, CallKind kind, F &&f) noexcept {
  try {
    const PluginCall call(owner, what, kind);
    if constexpr (std::is_invocable_v<F, const PluginCall &>)
      return f(call);
    else
      return f();
  } catch (...) {
    logException(owner, what);
    return C3DE_E_EXCEPTION;
  }
}

/// A copy that is never freed, one for each distinct text.
[[nodiscard]] const char *internedName(std::string_view name);

/// A long call, as reported by the watchdog.
struct LongCall {
  std::string owner, what;
  CallKind kind = CallKind::prompt;
  std::uint64_t subject = 0;
  double seconds = 0.0;     ///< since it began or last reported progress; accurate to about a tenth of the limit
  bool isOver = false;      ///< it has returned, or reported progress
  bool isOnMain = false;    ///< on the thread that created the watchdog
  bool isRepeated = false;  ///< it was reported before
};

/// Monitors calls from a separate thread and reports each long one: at the limit, whenever its duration has tripled
/// since the last report, and at the end.
class CallWatchdog {
 public:
  struct Limits {
    std::chrono::milliseconds prompt{2000};
    std::chrono::milliseconds work{10000};  ///< for jobs and steps
  };
  /// @param tell  called on the watchdog's thread
  CallWatchdog(const Limits &limits, std::function<void(const LongCall &)> tell);
  ~CallWatchdog();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// From now on, plugin code that terminates the program (exit, quick_exit, on Linux _exit), also on a thread of its
/// own, is named on stderr and in the journal, and the exit code is `code`. Call on the main thread. exit_group is not
/// detected.
void reportPluginExits(int code);

}  // namespace c3de
