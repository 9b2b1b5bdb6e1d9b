// SPDX-License-Identifier: Apache-2.0
// Largest frequency of any stiffness operator. Private to the core.
#pragma once

#include "pointbased/types.h"

namespace pointbased::detail {

/// df = -K du of a symmetric K.
using StiffnessProduct = std::function<void(std::span<const Vec3> du, std::span<Vec3> df)>;

/// largestFrequency() for K; `extra` has the same meaning.
[[nodiscard]] double largestFrequencyOf(const StiffnessProduct &product, std::span<const double> masses,
                                        std::span<const double> extra, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
