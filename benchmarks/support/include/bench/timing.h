// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace bench {

/// Wall time of many runs of one function.
struct Timing {
  double median_ms = 0.0, p01_ms = 0.0, p95_ms = 0.0, p99_ms = 0.0, least_ms = 0.0;
  std::size_t runs = 0;
};
[[nodiscard]] Timing summaryOf(std::vector<double> samples_ms);

/// Warms up, then runs f for about `seconds`, at least 21 times.
[[nodiscard]] Timing measure(double seconds, const std::function<void()> &f);

/// Several functions in turns, ten runs each, so that other load on the machine affects all of them: for ratios.
/// @param seconds  each
[[nodiscard]] std::vector<Timing> measureInTurns(double seconds, const std::vector<std::function<void()>> &functions);

/// ms, of the process (all threads): other load on the machine has little effect.
[[nodiscard]] double processor_ms();
/// ms, of a monotonic clock.
[[nodiscard]] double wall_ms();

/// Prevents the compiler from removing the computation of `value`.
void keep(double value);

}  // namespace bench
