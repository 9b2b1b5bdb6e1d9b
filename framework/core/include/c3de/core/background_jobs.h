// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/core/progress.h"

namespace c3de {

class MainQueue;

/// Long work while the window stays responsive: one thread per running job, progress for a bar, cancellation, and the
/// result delivered on the main thread.
class BackgroundJobs {
 public:
  explicit BackgroundJobs(MainQueue &mainQueue);
  ~BackgroundJobs();  ///< cancels and joins; done() of unfinished jobs is called with ErrorCode::cancelled

  using Run = std::function<Expected<void>(const ProgressFn &)>;
  using Done = std::function<void(const Expected<void> &)>;
  /// Main thread. done() is called once, on the main thread. While the destructor runs, no job is started and the
  /// handle is null.
  Handle submit(std::string owner, std::string title, Run run, Done done);
  bool cancel(Handle job);
  /// Cancels, awaits and finishes the jobs of a plugin before it is removed. Main thread.
  void finishOwnedBy(const std::string &owner);

  struct Status {
    Handle handle;
    std::string title, what;
    double fraction = -1.0;
    bool cancelling = false;
    double age_s = 0.0;  ///< since it was submitted
  };
  [[nodiscard]] std::vector<Status> running() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de
