// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "c3de/core/expected.h"

namespace c3de::study {

/// The lowest frequency that a signal swings with, Hz: the lowest peak of its amplitude spectrum (Hann window, mean and
/// trend taken off) of at least a tenth of the highest one, its top found between the lines of the spectrum. Errors
/// (ErrorCode::state): fewer than three periods, or no swing.
/// @param time_s  growing; unequal distances are allowed
[[nodiscard]] Expected<double> firstFrequency(std::span<const double> time_s, std::span<const double> signal);

}  // namespace c3de::study
