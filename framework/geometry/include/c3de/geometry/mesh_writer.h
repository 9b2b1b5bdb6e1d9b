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
  std::vector<PointArray> arrays;  ///< a row per vertex; stored by PLY and VTP, not supported by OBJ and STL
  std::string title;               ///< one line for the head of the file; truncated if too long
};

/// Writes OBJ, STL (binary, 32-bit coordinates), PLY (binary) or VTP (XML, appended base64), by the extension.
/// Coordinates are LPS millimetres; the head of the file states this as `SPACE=LPS UNITS=mm`, which loadMesh() reads.
/// The file appears complete or not at all; an existing one stays until then. Errors name the path: ErrorCode::usage
/// for another extension (lists the accepted ones), ErrorCode::state for a mesh without triangles, invalid indices or
/// numbers of rows, non-finite coordinates, ErrorCode::output when it cannot be written. Any thread.
[[nodiscard]] Expected<void> writeMesh(const std::filesystem::path &path, const TriangleMesh &mesh,
                                       const MeshWriteOptions &options = {});

/// Extensions that writeMesh() supports, lower case with the dot.
[[nodiscard]] std::span<const std::string_view> writableMeshExtensions();

}  // namespace c3de::geometry
