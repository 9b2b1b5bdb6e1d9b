// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <span>

#include "c3de/core/expected.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::session {

/// Fits the skins of the pieces of one body, which are smoothed separately, so that they meet halfway. A vertex that is
/// close to another skin and faces it moves half the distance, twice. Remaining gaps are the sagitta of edges over
/// curved regions.
/// @param reach_mm  > 0, search distance inside the other skin; outside a third of it
/// Errors: a skin with a vertex that is not finite.
[[nodiscard]] Expected<void> fitSkins(std::span<geometry::TriangleMesh *const> skins, double reach_mm);

}  // namespace c3de::session
