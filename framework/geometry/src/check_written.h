// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/point_array.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Refuses non-finite coordinates, arrays whose number of rows differs from that of points, arrays without a name or
/// with a duplicate one. ErrorCode::state.
[[nodiscard]] Expected<void> checkRows(const std::filesystem::path &path, const std::vector<Vec3> &points,
                                       std::span<const PointArray> arrays);
/// Checks that indices are in range.
[[nodiscard]] Expected<void> checkTriangles(const std::filesystem::path &path, const TriangleMesh &mesh);

}  // namespace c3de::geometry
