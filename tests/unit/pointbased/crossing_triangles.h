// SPDX-License-Identifier: Apache-2.0
// Detects crossing skins, independently of the engine.
#pragma once

#include "pointbased/simulator.h"

namespace shapes {

/// Pairs of triangles of the drawn skins of two bodies that cross: an edge of one passes through the other.
[[nodiscard]] std::size_t crossings(pointbased::Simulator &simulator, std::size_t first, std::size_t second);
/// Crossings of a skin with itself; triangles that share a corner do not count.
[[nodiscard]] std::size_t crossings(pointbased::Simulator &simulator, std::size_t body);

}  // namespace shapes
