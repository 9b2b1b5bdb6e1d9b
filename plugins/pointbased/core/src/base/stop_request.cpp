// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stop_request.h"

#include <algorithm>
#include <functional>

namespace pointbased {
namespace {

// Nested loops run on workers, from which no exception may be thrown.
thread_local bool insideLoop = false;

constexpr std::size_t kGrainsBetweenLooks = 16;

}  // namespace

StoppableLoops::StoppableLoops(ParallelFor inner)
    : loops_([inner = std::move(inner), watched = stop_](std::size_t n, std::size_t grain,
                                                         const std::function<void(std::size_t, std::size_t)> &loop) {
        const StopRequest *stop = *watched;
        if (stop == nullptr) return inner(n, grain, loop);
        const auto part = [&loop, grain, stop](std::size_t begin, std::size_t end) {
          const bool outer = insideLoop;
          insideLoop = true;
          // A single thread gets the whole range at once.
          const std::size_t piece = kGrainsBetweenLooks * std::max<std::size_t>(1, grain);
          for (; begin < end && !stop->isRaised(); begin += std::min(piece, end - begin))  // the caller throws
            loop(begin, std::min(end, begin + piece));
          insideLoop = outer;
        };
        if (n > 0) inner(n, grain, std::cref(part));
        if (!insideLoop) throwIfStopRequested(stop);
      }) {}

}  // namespace pointbased
