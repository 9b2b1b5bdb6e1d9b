// SPDX-License-Identifier: Apache-2.0
#include "c3de/session/step_limit.h"

#include "c3de/session/interrupt.h"
#include "c3de/session/simulator_access.h"

namespace c3de::session {
namespace {

constexpr std::chrono::milliseconds kPollInterval{50};  // a signal wakes no thread

}  // namespace

StepLimit::StepLimit(c3de_object *simulator, const c3de_simulator_v1 *table,
                     std::optional<std::chrono::steady_clock::time_point> deadline)
    : simulator_(simulator), table_(table), deadline_(deadline) {
  if (endsSteps(table)) thread_ = std::thread([this] { watch(); });
}

StepLimit::~StepLimit() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_one();
  thread_.join();
  // The next user of the simulator may continue.
  (void)table_->interrupt(simulator_, 0);
}

void StepLimit::watch() {
  std::unique_lock lock(mutex_);
  while (!over_) {
    if (wasInterrupted() || (deadline_ && std::chrono::steady_clock::now() >= *deadline_)) {
      (void)table_->interrupt(simulator_, 1);
      return;
    }
    changed_.wait_for(lock, kPollInterval);
  }
}

}  // namespace c3de::session
