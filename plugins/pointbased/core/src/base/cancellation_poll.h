// SPDX-License-Identifier: Apache-2.0
// Cancellation of serial code between cancellable loops. Private to the core.
#pragma once

#include "pointbased/stop_request.h"

namespace pointbased::detail {

/// Throws Stopped where the loops would (StoppableLoops); to be called a few times per second.
inline void checkCancelled(const ParallelFor &parallelFor) {
  parallelFor(0, 1, [](std::size_t, std::size_t) {});
}

inline constexpr std::size_t kPollInterval = 1 << 14;  // parts of a body between two checks

/// Checks for cancellation at intervals; to be called once per part in a serial loop.
class CancellationPoll {
 public:
  explicit CancellationPoll(const ParallelFor &parallelFor) : parallelFor_(parallelFor) {}
  void operator()() {
    if (++seen_ % kPollInterval == 0) checkCancelled(parallelFor_);
  }

 private:
  const ParallelFor &parallelFor_;
  std::size_t seen_ = 0;
};

}  // namespace pointbased::detail
