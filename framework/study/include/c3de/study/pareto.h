// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace c3de::study {

/// Cost of a setting in all its timings, and its error.
struct Tradeoff {
  double cheapest = 0.0, dearest = 0.0;  ///< of the repeats
  double error = 0.0;
};

/// The points on the Pareto front. A point is on it if no other one is at least as accurate and cheaper by more than
/// the noise. The latter means that its dearest repeat is cheaper than the cheapest one of this point. Errors below the
/// floor count as equal to it.
/// @param floor  the uncertainty of the reference
[[nodiscard]] std::vector<bool> paretoFront(std::span<const Tradeoff> points, double floor);

}  // namespace c3de::study
