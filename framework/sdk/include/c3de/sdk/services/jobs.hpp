// SPDX-License-Identifier: Apache-2.0
// Parallel loops and jobs in the background.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "c3de/sdk/guard.hpp"
#include "c3de/sdk/services/service.hpp"

namespace c3de::sdk {

/// What a running job tells about itself.
class Progress {
 public:
  explicit Progress(const c3de_progress *progress) noexcept : progress_(progress) {}
  /// False: stop soon, somebody cancelled. fraction in 0 … 1, negative: unknown.
  [[nodiscard]] bool update(double fraction, std::string_view what) const noexcept {
    return !progress_ || progress_->update(progress_->self, fraction, str(what)) >= 0;
  }
  [[nodiscard]] const c3de_progress *abi() const noexcept { return progress_; }

 private:
  const c3de_progress *progress_;
};

class Jobs : public Service<c3de_jobs_v1> {
 public:
  using Service::Service;

  /// Calls body(begin, end) for disjoint ranges that cover [0, n). Serial when the service is absent. An exception of
  /// the body is thrown here when every range is done.
  template <class Body>
  void parallelFor(std::size_t n, std::size_t grain, Body &&body) const {
    if (!table_) {
      if (n > 0) body(std::size_t{0}, n);
      return;
    }
    struct Call {
      std::remove_reference_t<Body> &body;
      std::mutex mutex;
      std::exception_ptr thrown;
    } callState{body, {}, {}};
    const auto run = [](void *self, std::uint64_t begin, std::uint64_t end) noexcept {
      auto &state = *static_cast<Call *>(self);
      try {
        state.body(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
      } catch (...) {
        const std::lock_guard lock(state.mutex);
        if (!state.thrown) state.thrown = std::current_exception();
      }
    };
    table_->parallel_for(table_->ctx, n, grain, &callState, +run);
    if (callState.thrown) std::rethrow_exception(callState.thrown);
  }
  [[nodiscard]] unsigned threadCount() const noexcept { return table_ ? table_->thread_count(table_->ctx) : 1u; }

  using Run = std::function<Result<void>(Progress)>;       ///< on a worker
  using Done = std::function<void(const Result<void> &)>;  ///< on the main thread, once, also when cancelled
  /// Runs in the background with a progress bar. Main thread.
  Result<c3de_handle> submit(std::string_view title, Run run, Done done) const {
    auto box = std::make_unique<Box>(Box{std::move(run), std::move(done)});
    const c3de_job job{sizeof(c3de_job), 0, str(title), box.get(), &Box::runThunk, &Box::doneThunk};
    c3de_handle handle{0};
    if (auto submitted = call<&c3de_jobs_v1::submit>(&job, &handle); !submitted) return submitted.failure();
    (void)box.release();  // done() deletes it
    return handle;
  }
  Result<void> cancel(c3de_handle job) const { return call<&c3de_jobs_v1::cancel>(job); }

  struct State {
    double fraction = -1.0;
    std::string what;
  };
  /// A failure with C3DE_E_STALE once the job is finished.
  Result<State> progress(c3de_handle job) const {
    State state;
    TextSink what;
    if (auto done = call<&c3de_jobs_v1::progress>(job, &state.fraction, what.sink()); !done) return done.failure();
    state.what = what.take();
    return state;
  }

 private:
  struct Box {
    Run run;
    Done done;
    static c3de_status C3DE_CALL runThunk(void *self, const c3de_progress *progress) noexcept {
      return guard([&] { return static_cast<Box *>(self)->run(Progress(progress)); });
    }
    static void C3DE_CALL doneThunk(void *self, c3de_status status, c3de_str error) noexcept {
      const std::unique_ptr<Box> box(static_cast<Box *>(self));
      guardQuietly("job", [&] {
        if (!box->done) return;
        if (status < 0)
          box->done(Failure{status, std::string(text(error))});
        else
          box->done({});
      });
    }
  };
};

}  // namespace c3de::sdk
