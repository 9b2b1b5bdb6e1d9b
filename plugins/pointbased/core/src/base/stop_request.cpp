// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stop_request.h"

#include <functional>

namespace pointbased {
namespace {

// A loop within a loop runs on a worker, from which nothing may be thrown.
thread_local bool insideLoop = false;

}  // namespace

StoppableLoops::StoppableLoops(ParallelFor inner)
    : loops_([inner = std::move(inner), watched = stop_](std::size_t n, std::size_t grain,
                                                         const std::function<void(std::size_t, std::size_t)> &loop) {
        const StopRequest *stop = *watched;
        if (stop == nullptr) return inner(n, grain, loop);
        const auto part = [&loop, stop](std::size_t begin, std::size_t end) {
          if (stop->isRaised()) return;  // the caller throws
          const bool outer = insideLoop;
          insideLoop = true;
          loop(begin, end);
          insideLoop = outer;
        };
        if (n > 0) inner(n, grain, std::cref(part));
        if (!insideLoop) endIfRaised(stop);
      }) {}

}  // namespace pointbased
