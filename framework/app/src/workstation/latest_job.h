// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "app.h"
#include "c3de/core/background_jobs.h"
#include "c3de/session/session.h"

namespace c3de::app {

/// A background job of which only the latest counts: a cancelled or replaced one delivers no result, nor does any after
/// this object. Main thread.
class LatestJob {
 public:
  explicit LatestJob(BackgroundJobs &jobs) : jobs_(jobs) {}
  ~LatestJob() { ++*serial_; }
  LatestJob(const LatestJob &) = delete;
  LatestJob &operator=(const LatestJob &) = delete;

  [[nodiscard]] bool isRunning() const { return !job_.isNull(); }
  /// Cancels the job that runs.
  void start(std::string title, BackgroundJobs::Run run, BackgroundJobs::Done done) {
    cancel();
    job_ =
        jobs_.submit(kJobOwner, std::move(title), std::move(run),
                     [this, latest = serial_, serial = *serial_, done = std::move(done)](const Expected<void> &result) {
                       if (*latest != serial) return;
                       job_ = {};
                       done(result);
                     });
  }
  void cancel() {
    ++*serial_;
    if (!job_.isNull()) jobs_.cancel(std::exchange(job_, {}));
  }

 private:
  BackgroundJobs &jobs_;
  Handle job_;
  std::shared_ptr<std::uint64_t> serial_ = std::make_shared<std::uint64_t>(0);
};

}  // namespace c3de::app
