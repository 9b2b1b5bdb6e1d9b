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

}  // namespace pointbased::detail
