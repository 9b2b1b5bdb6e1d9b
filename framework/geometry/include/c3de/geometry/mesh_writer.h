// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/point_array.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

struct MeshWriteOptions {
  std::vector<PointArray> arrays;  ///< a row per vertex; kept by PLY and VTP, OBJ and STL have no place for them
  std::string title;               ///< one line for the head of the file; what does not fit is cut
};

/// Writes OBJ, STL (binary, 32-bit coordinates), PLY (binary) or VTP (XML, appended base64), by the extension: LPS
/// millimetres, which the head of the file says as `SPACE=LPS UNITS=mm` and loadMesh() reads again. The file appears
/// complete or not at all; one that was there stays until then. Errors name the path: ErrorCode::usage for another
/// extension (and says which are accepted), ErrorCode::state for a mesh without triangles, indices or rows that do not
/// fit, coordinates that are not finite, ErrorCode::output when it cannot be written. Any thread.
[[nodiscard]] Expected<void> writeMesh(const std::filesystem::path &path, const TriangleMesh &mesh,
                                       const MeshWriteOptions &options = {});

/// Extensions that writeMesh() takes, lower case with the dot.
[[nodiscard]] std::span<const std::string_view> writableMeshExtensions();

}  // namespace c3de::geometry
