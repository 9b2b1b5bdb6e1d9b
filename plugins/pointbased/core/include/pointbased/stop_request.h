// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pointbased/types.h"

namespace pointbased {

/// Whether somebody has asked for the end of what is being computed. Asked often, from every thread that computes.
class StopRequest {
 public:
  virtual ~StopRequest() = default;
  [[nodiscard]] virtual bool isRaised() const noexcept = 0;
};

/// Thrown on the thread that has called a computation when it is ended half way. What the computation was writing is of
/// no use then. Simulator::step() and buildRestState() take it as what it is; it never leaves a loop's worker.
struct Stopped {};

/// For serial work that takes long: to be asked several times a second.
inline void endIfRaised(const StopRequest *stop) {
  if (stop != nullptr && stop->isRaised()) throw Stopped{};
}

/// Loops that end early, with Stopped, while somebody watches for a request; else the loops that they are made of. What
/// is built from such loops carries the request through every stage of a computation.
class StoppableLoops {
 public:
  explicit StoppableLoops(ParallelFor inner);

  [[nodiscard]] const ParallelFor &parallelFor() const { return loops_; }

  /// Loops of other threads must not be running when it begins and ends.
  class Watch {
   public:
    /// @param stop  null: nobody; must outlive the watch
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
