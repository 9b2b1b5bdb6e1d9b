// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/mesh_report.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

struct LoadedMesh {
  TriangleMesh mesh;
  MeshReport report;
};

/// Reads OBJ, STL, PLY, VTK polydata (legacy .vtk, uncompressed XML .vtp), OFF and glTF. Polygons become triangles,
/// vertices at equal positions are welded, degenerate and duplicate triangles removed, an inside-out surface is
/// flipped: each with a line in the report. Refused with the reason: unreadable or empty files, no faces, indices out
/// of range, coordinates that are not finite or beyond 1e9 mm. A comment `SPACE=RAS` in the head of the file converts x
/// and y to LPS, with a line in the report.
/// @param unit  of the numbers in the file; vertices become millimetres. None: the unit in a comment such as `UNITS=mm`
///              in the head, otherwise mm. A given unit takes precedence; the report warns if the file states another.
[[nodiscard]] Expected<LoadedMesh> loadMesh(const std::filesystem::path &path, std::optional<LengthUnit> unit,
                                            const ProgressFn &progress = {});

/// The unit in a comment in the head of the file, for example `SPACE=LPS UNITS=mm`.
[[nodiscard]] std::optional<LengthUnit> unitInFile(const std::filesystem::path &path);

/// Extensions that loadMesh() reads, lower case with the dot: ".obj", ".stl", ...
[[nodiscard]] std::span<const std::string_view> meshExtensions();
[[nodiscard]] bool isMeshFile(const std::filesystem::path &path);  ///< by its extension alone

/// The same checks and clean-up for a mesh from another source; its numbers are in the given unit.
/// @param origin  prefix of error messages  @param notes  sentences about omissions, for the report
[[nodiscard]] Expected<LoadedMesh> buildMesh(TriangleMesh raw, LengthUnit unit, const std::string &origin = "mesh",
                                             std::vector<std::string> notes = {}, const ProgressFn &progress = {});
/// Warning about a file whose stated unit differs from the requested one.
[[nodiscard]] std::string unitsDiffer(LengthUnit said, LengthUnit stated);

}  // namespace c3de::geometry
