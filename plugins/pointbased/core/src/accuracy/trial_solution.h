// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pointbased/accuracy.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// A body with the sampling of its recipe in equilibrium under a thousandth of its loads, by the linear law. Errors:
/// those of buildRestState(); no equilibrium.
[[nodiscard]] Result<std::unique_ptr<Body>> solvedTrial(const AccuracyProblem &problem, const ParallelFor &parallelFor,
                                                        const StopRequest *stop);

}  // namespace pointbased::detail
