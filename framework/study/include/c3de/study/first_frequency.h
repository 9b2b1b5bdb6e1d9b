// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "c3de/core/expected.h"

namespace c3de::study {

/// The lowest frequency of a signal, Hz: the lowest peak of its amplitude spectrum (Hann window, mean and trend
/// removed) of at least a tenth of the highest one. The maximum is interpolated between the lines of the spectrum.
/// Errors (ErrorCode::state): fewer than three periods, or no oscillation.
/// @param time_s  increasing; unequal intervals are allowed
[[nodiscard]] Expected<double> firstFrequency(std::span<const double> time_s, std::span<const double> signal);

}  // namespace c3de::study
