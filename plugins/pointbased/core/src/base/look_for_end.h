// SPDX-License-Identifier: Apache-2.0
// For serial stretches between loops that may be ended. Private to the core.
#pragma once

#include "pointbased/stop_request.h"

namespace pointbased::detail {

/// Ends here, with Stopped, where the loops would (StoppableLoops); to be asked a few times a second.
inline void lookForEnd(const ParallelFor &parallelFor) {
  parallelFor(0, 1, [](std::size_t, std::size_t) {});
}

inline constexpr std::size_t kLookEvery = 1 << 14;  // parts of a body between two looks

/// Called once for each part in a serial loop, looks often enough.
class Looks {
 public:
  explicit Looks(const ParallelFor &parallelFor) : parallelFor_(parallelFor) {}
  void operator()() {
    if (++seen_ % kLookEvery == 0) lookForEnd(parallelFor_);
  }

 private:
  const ParallelFor &parallelFor_;
  std::size_t seen_ = 0;
};

}  // namespace pointbased::detail
