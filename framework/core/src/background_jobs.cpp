// SPDX-License-Identifier: Apache-2.0
#include "c3de/core/background_jobs.h"

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "c3de/core/main_queue.h"

namespace c3de {

struct BackgroundJobs::Impl {
  struct Job {
    std::string owner, title;
    Run run;
    Done done;
    std::thread thread;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    std::atomic<bool> cancelling{false};
    std::atomic<bool> finished{false};
    Expected<void> result;
    std::mutex mutex;  // what, fraction
    std::string what;
    double fraction = -1.0;
  };

  explicit Impl(MainQueue &queue) : mainQueue(queue) {}

  MainQueue &mainQueue;
  HandleTable<std::shared_ptr<Job>, HandleKind::job> jobs;  // main thread only
  // Posted functions may outlive this object; they check this flag before they access it.
  std::shared_ptr<bool> alive = std::make_shared<bool>(true);

  void finish(Handle handle) {
    const std::shared_ptr<Job> *found = jobs.find(handle);
    if (!found) return;
    const std::shared_ptr<Job> job = *found;
    if (job->thread.joinable()) job->thread.join();
    jobs.remove(handle);
    if (job->done) job->done(job->result);
  }
};

BackgroundJobs::BackgroundJobs(MainQueue &mainQueue) : impl_(std::make_unique<Impl>(mainQueue)) {}

BackgroundJobs::~BackgroundJobs() {
  *impl_->alive = false;
  std::vector<Handle> all;
  impl_->jobs.forEach([&](Handle h, const std::shared_ptr<Impl::Job> &job) {
    job->cancelling = true;
    all.push_back(h);
  });
  for (const Handle h : all) impl_->finish(h);
}

Handle BackgroundJobs::submit(std::string owner, std::string title, Run run, Done done) {
  if (!*impl_->alive) return {};  // submitted by the done() of a job that the destructor ends
  auto job = std::make_shared<Impl::Job>();
  job->owner = std::move(owner);
  job->title = std::move(title);
  job->run = std::move(run);
  job->done = std::move(done);
  const Handle handle = impl_->jobs.add(job);
  Impl *impl = impl_.get();
  job->thread = std::thread([impl, job, handle, alive = impl->alive, &queue = impl->mainQueue] {
    const ProgressFn progress = [&](double fraction, const std::string &what) {
      {
        std::lock_guard lock(job->mutex);
        job->fraction = fraction;
        job->what = what;
      }
      queue.requestRedraw();
      return !job->cancelling.load();
    };
    job->result = job->run(progress);
    job->finished = true;
    queue.post([impl, handle, alive] {
      if (*alive) impl->finish(handle);
    });
  });
  return handle;
}

bool BackgroundJobs::cancel(Handle handle) {
  std::shared_ptr<Impl::Job> *job = impl_->jobs.find(handle);
  if (!job) return false;
  (*job)->cancelling = true;
  return true;
}

void BackgroundJobs::finishOwnedBy(const std::string &owner) {
  std::vector<Handle> owned;
  impl_->jobs.forEach([&](Handle h, const std::shared_ptr<Impl::Job> &job) {
    if (job->owner == owner) {
      job->cancelling = true;
      owned.push_back(h);
    }
  });
  for (const Handle h : owned) impl_->finish(h);
}

std::vector<BackgroundJobs::Status> BackgroundJobs::running() const {
  std::vector<Status> out;
  impl_->jobs.forEach([&](Handle h, const std::shared_ptr<Impl::Job> &job) {
    std::lock_guard lock(job->mutex);
    out.push_back({h, job->title, job->what, job->fraction, job->cancelling.load(),
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - job->start).count()});
  });
  return out;
}

}  // namespace c3de
