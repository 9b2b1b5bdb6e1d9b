// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pointbased/types.h"

namespace pointbased {

/// Request to cancel a computation. Queried often, from every computing thread.
class StopRequest {
 public:
  virtual ~StopRequest() = default;
  [[nodiscard]] virtual bool isRaised() const noexcept = 0;
};

/// Thrown on the calling thread of a computation that is cancelled. Partial results are invalid then. Simulator::step()
/// and buildRestState() catch it; it never leaves a worker of a loop.
struct Stopped {};

/// For long serial work: call several times a second.
inline void throwIfStopRequested(const StopRequest *stop) {
  if (stop != nullptr && stop->isRaised()) throw Stopped{};
}

/// Loops that end early, with Stopped, while a Watch exists whose request is raised; otherwise the loops they wrap.
/// Everything built on such loops passes the request to every stage of a computation.
class StoppableLoops {
 public:
  explicit StoppableLoops(ParallelFor inner);

  [[nodiscard]] const ParallelFor &parallelFor() const { return loops_; }

  /// No loops of other threads may run when a watch begins and ends.
  class Watch {
   public:
    /// @param stop  null: no request; must outlive the watch
    Watch(StoppableLoops &loops, const StopRequest *stop) : stop_(loops.stop_) { *stop_ = stop; }
    ~Watch() { *stop_ = nullptr; }
    Watch(const Watch &) = delete;
    Watch &operator=(const Watch &) = delete;

   private:
    std::shared_ptr<const StopRequest *> stop_;
  };

 private:
  std::shared_ptr<const StopRequest *> stop_ = std::make_shared<const StopRequest *>(nullptr);
  ParallelFor loops_;
};

}  // namespace pointbased
