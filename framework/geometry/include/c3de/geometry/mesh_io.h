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

/// Reads OBJ, STL, PLY, VTK polydata (legacy .vtk, uncompressed XML .vtp), OFF and glTF; polygons become triangles,
/// vertices at equal positions are welded, degenerate and duplicate triangles dropped, an inside-out surface is turned:
/// each with a line in the report. Refused with the reason: unreadable or empty files, no faces, indices out of range,
/// coordinates that are not finite or beyond 1e9 mm. A comment `SPACE=RAS` in the head of the file turns x and y to
/// LPS, with a line in the report.
/// @param unit  of the numbers in the file; vertices become millimetres. None: what a comment such as `UNITS=mm` in the
///              head says, else mm. A unit that is given wins; where the file says another one, the report warns.
[[nodiscard]] Expected<LoadedMesh> loadMesh(const std::filesystem::path &path, std::optional<LengthUnit> unit,
                                            const ProgressFn &progress = {});

/// The unit that a comment in the head of the file says, for example `SPACE=LPS UNITS=mm`.
[[nodiscard]] std::optional<LengthUnit> unitInFile(const std::filesystem::path &path);

/// Extensions that loadMesh() reads, lower case with the dot: ".obj", ".stl", ...
[[nodiscard]] std::span<const std::string_view> meshExtensions();
[[nodiscard]] bool isMeshFile(const std::filesystem::path &path);  ///< by its extension alone

/// The same checks and clean-up for a mesh that was made elsewhere; its numbers are in the given unit.
/// @param origin  begins error messages  @param notes  sentences about what was left out, for the report
[[nodiscard]] Expected<LoadedMesh> buildMesh(TriangleMesh raw, LengthUnit unit, const std::string &origin = "mesh",
                                             std::vector<std::string> notes = {}, const ProgressFn &progress = {});
/// Warning about a file whose unit is not the one that was asked for.
[[nodiscard]] std::string unitsDiffer(LengthUnit said, LengthUnit stated);

}  // namespace c3de::geometry
