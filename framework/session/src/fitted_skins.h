// SPDX-License-Identifier: Apache-2.0
// Private to the session.
#pragma once

#include <span>

#include "c3de/core/expected.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::session {

/// Skins of the pieces of one body, each smoothed by itself, meet in the middle: a vertex that another skin is near to
/// and faces goes half of the way there, twice. What is left are the heights of edges over curved places.
/// @param reach_mm  > 0, how far inside; outside a third of that
/// Errors: a skin with a vertex that is not finite.
[[nodiscard]] Expected<void> fitSkins(std::span<geometry::TriangleMesh *const> skins, double reach_mm);

}  // namespace c3de::session
