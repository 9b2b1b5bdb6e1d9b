// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/session/landmark_file.h"

namespace c3de::session {

/// Points of a table, LPS.
struct MeasuredPoints {
  std::vector<Vec3> points_mm;
  std::vector<Vec3> normals;              ///< unit; empty: the table has none, otherwise one per point
  std::vector<FileLandmark> landmarks{};  ///< rows with a name in the column `landmark`; no points of the surface
};

/// Maximum number of points in a file.
inline constexpr std::size_t kMaxMeasuredPoints = 1000000;

/// Reads measured points by the extension of the file. CSV: with a first row of names, the columns `x`, `y`, `z` (or
/// `x_mm`, `y_mm`, `z_mm`) in any order, and `nx`, `ny`, `nz` where there are normals. A row with a name in the column
/// `landmark` is where that landmark was measured, without a normal. Other columns are ignored. Without names, three
/// columns x, y, z, or six with the normal behind. `.fcsv` and `.mrk.json` are fiducials of 3D Slicer, in mm. Errors
/// (ErrorCode::input) state file, line, value and what is accepted. Any thread.
/// @param unit  of the numbers of a CSV; none: mm, the only one of fiducials
[[nodiscard]] Expected<MeasuredPoints> readMeasuredPoints(const std::filesystem::path &file,
                                                          std::optional<geometry::LengthUnit> unit);

/// Refuses tables with rows of landmarks (ErrorCode::input), for callers that read landmarks from another file. Any
/// thread.
[[nodiscard]] Expected<void> checkNoLandmarks(const MeasuredPoints &measured);

}  // namespace c3de::session
