// SPDX-License-Identifier: Apache-2.0
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include "base/thread_clock.h"

namespace pointbased {

ThreadClock ThreadClock::ofThisThread() {
  ThreadClock clock;
  if (const HANDLE thread = OpenThread(THREAD_QUERY_LIMITED_INFORMATION, FALSE, GetCurrentThreadId()))
    clock.thread_ = std::shared_ptr<void>(thread, [](void *handle) { CloseHandle(handle); });
  return clock;
}

std::int64_t ThreadClock::now() const noexcept {
  FILETIME created, ended, kernel, user;
  if (!thread_ || !GetThreadTimes(thread_.get(), &created, &ended, &kernel, &user)) return 0;
  const auto ticks = [](const FILETIME &time) {
    return static_cast<std::int64_t>((static_cast<std::uint64_t>(time.dwHighDateTime) << 32) | time.dwLowDateTime);
  };
  return 100 * (ticks(kernel) + ticks(user));
}

}  // namespace pointbased
