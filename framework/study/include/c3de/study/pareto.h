// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace c3de::study {

/// What a setting costs, as often as it was timed, and how wrong it is.
struct Tradeoff {
  double cheapest = 0.0, dearest = 0.0;  ///< of the repeats
  double error = 0.0;
};

/// Which points are on the front: no other one is at least as accurate and cheaper by more than the noise, that is its
/// dearest repeat is cheaper than the cheapest one of this point. Errors below the floor count as equal to it.
/// @param floor  the uncertainty of the reference
[[nodiscard]] std::vector<bool> paretoFront(std::span<const Tradeoff> points, double floor);

}  // namespace c3de::study
