// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "arguments.h"
#include "c3de/core/background_jobs.h"
#include "c3de/core/text.h"
#include "c3de/core/thread_pool.h"
#include "last_error.h"
#include "services/services.h"

namespace c3de::plugin_host {
namespace {

void C3DE_CALL parallelFor(void *ctx, std::uint64_t n, std::uint64_t grain, void *self,
                           void(C3DE_CALL *body)(void *self, std::uint64_t begin, std::uint64_t end)) noexcept {
  (void)serve(ctx, "jobs.parallel_for", [&](PluginContext &plugin) {
    requireNonNull(body, "body");
    if (n == 0) return;
    const PluginContext *owner = &plugin;
    const auto run = [owner, self, body](std::size_t begin, std::size_t end) {
      callPlugin(
          *owner, "the body of parallel_for", [&] { body(self, begin, end); }, CallKind::part);
    };
    if (ThreadPool *pool = plugin.services().pool)
      pool->parallelFor(static_cast<std::size_t>(n), static_cast<std::size_t>(std::max<std::uint64_t>(grain, 1)), run);
    else
      run(0, static_cast<std::size_t>(n));
  });
}

std::uint32_t C3DE_CALL threadCount(void *ctx) noexcept {
  std::uint32_t count = 1;
  (void)serve(ctx, "jobs.thread_count", [&](PluginContext &plugin) {
    if (plugin.services().pool) count = plugin.services().pool->threadCount();
  });
  return count;
}

/// A job in progress; both run and done are called through it.
struct Job {
  PluginContext *plugin = nullptr;
  c3de_job real{};
  c3de_status status = C3DE_E_CANCELLED;     ///< until run has returned
  Handle handle;                             ///< main thread
  std::atomic<std::uint64_t> handleBits{0};  ///< for reports about the job; 0 until submit has set it

  Expected<void> run(const ProgressFn &report) {
    struct Progress {
      const ProgressFn &report;
      const PluginCall *call;
    } now{report, nullptr};
    const auto update = [](void *self, double fraction, c3de_str what) noexcept -> c3de_status {
      try {
        const auto *progress = static_cast<const Progress *>(self);
        progress->call->noteProgress();
        const std::string_view text = fromAbi(what);
        return progress->report(fraction, displayText(text.substr(0, kLongestText))) ? C3DE_OK : C3DE_E_CANCELLED;
      } catch (...) {
        return refuse("progress");
      }
    };
    const c3de_progress progress{sizeof(c3de_progress), 0, &now, +update};
    setLastError(std::string_view());
    status = C3DE_E_EXCEPTION;
    handleBits.wait(0);
    const auto call = [&](const PluginCall &recorded) {
      now.call = &recorded;
      status = real.run(real.self, &progress);
    };
    callPlugin(*plugin, "the run of a job", call, CallKind::job, handleBits);
    if (status >= 0) return {};
    const std::string reason = takeLastError();
    return fail(errorCodeOf(status), reason.empty() ? statusName(status) : reason);
  }

  void done(const Expected<void> &result) {
    plugin->jobs.erase(handle.bits());
    const std::string text = result ? std::string() : result.error().message;
    callPlugin(*plugin, "the done of a job", [&] { real.done(real.self, status, toAbi(text)); });
  }
};

c3de_status C3DE_CALL submit(void *ctx, const c3de_job *job, c3de_handle *out) noexcept {
  return serveOnMain(ctx, "jobs.submit", [&](PluginContext &plugin) {
    requireNonNull(out, "out")->v = 0;
    const c3de_job in = tableOf(job, "job");
    const std::string title = labelOf(in.title, "title");
    if (title.empty()) throw Refusal(C3DE_E_ARG, "title is empty");
    auto shared = std::make_shared<Job>();
    shared->plugin = &plugin;
    shared->real = in;
    shared->real.title = {nullptr, 0};  // borrowed for this call only
    const Handle handle = plugin.services().jobs->submit(
        plugin.id(), title, [shared](const ProgressFn &progress) { return shared->run(progress); },
        [shared](const Expected<void> &result) { shared->done(result); });
    shared->handle = handle;
    shared->handleBits = handle.bits();
    shared->handleBits.notify_all();
    plugin.jobs.insert(handle.bits());
    writeHandle(out, handle);
  });
}

BackgroundJobs::Status find(PluginContext &plugin, c3de_handle job) {
  if (plugin.jobs.contains(job.v))
    for (BackgroundJobs::Status &status : plugin.services().jobs->running())
      if (status.handle == handleOf(job)) return std::move(status);
  plugin.jobs.erase(job.v);
  throw Refusal(C3DE_E_STALE, fmt::format("plugin {} has no running job of handle {}", plugin.id(), textOf(job)));
}

c3de_status C3DE_CALL cancel(void *ctx, c3de_handle job) noexcept {
  return serveOnMain(ctx, "jobs.cancel", [&](PluginContext &plugin) {
    (void)find(plugin, job);
    plugin.services().jobs->cancel(handleOf(job));
  });
}

c3de_status C3DE_CALL progress(void *ctx, c3de_handle job, double *fraction, c3de_sink what) noexcept {
  return serveOnMain(ctx, "jobs.progress", [&](PluginContext &plugin) -> c3de_status {
    requireNonNull(fraction, "fraction");
    const BackgroundJobs::Status status = find(plugin, job);
    *fraction = status.fraction;
    return what.put ? what.put(what.self, status.what.data(), status.what.size()) : C3DE_OK;
  });
}

}  // namespace

c3de_jobs_v1 makeJobsTable(PluginContext *plugin) {
  return {sizeof(c3de_jobs_v1), kServiceRevision, plugin, &parallelFor, &threadCount, &submit, &cancel, &progress};
}

}  // namespace c3de::plugin_host
