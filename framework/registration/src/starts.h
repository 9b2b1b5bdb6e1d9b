// SPDX-License-Identifier: Apache-2.0
// Private to registration: the global search.
#pragma once

#include <vector>

#include "robust_fit.h"

namespace c3de::registration {

/// The best of very many motions from the measured points to the body, rated coarsely, best first; those that move the
/// points almost equally occur once. Their errors are within the reach of refine().
[[nodiscard]] std::vector<Mat4> startsOf(const TargetSurface &target, const MovingPoints &moving, std::size_t count,
                                         ThreadPool *pool);

}  // namespace c3de::registration
