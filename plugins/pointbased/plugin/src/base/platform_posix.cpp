// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>

#include <ctime>

#include "base/thread_clock.h"

namespace pointbased {

ThreadClock ThreadClock::ofThisThread() {
  ThreadClock clock;
  clockid_t id{};
  if (pthread_getcpuclockid(pthread_self(), &id) == 0) clock.thread_ = std::make_shared<clockid_t>(id);
  return clock;
}

std::int64_t ThreadClock::now() const noexcept {
  timespec time{};
  if (!thread_ || clock_gettime(*static_cast<const clockid_t *>(thread_.get()), &time) != 0) return 0;
  return 1'000'000'000 * static_cast<std::int64_t>(time.tv_sec) + time.tv_nsec;
}

}  // namespace pointbased
