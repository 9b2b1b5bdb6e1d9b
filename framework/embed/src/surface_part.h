// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::embed {

/// A part of a surface: triangles between its own positions, with the orientation of the whole.
struct SurfacePart {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// The surface inside a box, its faces included: triangles are cut at them.
[[nodiscard]] SurfacePart partInBox(std::span<const Vec3> positions, const Triangles &triangles, const Vec3 &min,
                                    const Vec3 &max);
/// The triangles whose corners are all chosen. @param chosen  [positions]
[[nodiscard]] SurfacePart partOfVertices(std::span<const Vec3> positions, const Triangles &triangles,
                                         const std::vector<bool> &chosen);

}  // namespace c3de::embed
