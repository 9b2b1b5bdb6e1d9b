// SPDX-License-Identifier: Apache-2.0
// Output of the readers for the clean-up: values as stored in the file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::geometry {

/// A face with more corners is refused: no mesh of an organ has them, and triangulation is quadratic.
inline constexpr std::size_t kMaxFaceCorners = 32767;
/// |coordinate| in mm (a thousand kilometres); a larger value is not a length.
inline constexpr double kMaxCoordinate_mm = 1e9;

struct RawMesh {
  std::vector<Vec3> vertices;       ///< in the unit of the file
  std::vector<Triangle> triangles;  ///< indices are in range
  std::size_t polygonsSplit = 0;    ///< faces with more than three corners
  std::size_t facesDropped = 0;     ///< faces with fewer than three different corners
  std::vector<std::string> notes;   ///< omissions of the reader, a sentence each
};

/// Adds a face as triangles, without repeated consecutive corners. A face with fewer than three different corners is
/// only counted. @returns  false for a concave polygon with more than 4096 corners; nothing is added then
[[nodiscard]] bool addFace(RawMesh &raw, std::span<const unsigned> corners);

/// Errors of the readers: "file:line: what, value, what is accepted". @param millimetresPerUnit  for the range check
[[nodiscard]] Expected<RawMesh> readObj(const std::filesystem::path &path, double millimetresPerUnit);
[[nodiscard]] Expected<RawMesh> readStl(const std::filesystem::path &path);
[[nodiscard]] Expected<RawMesh> readVtk(const std::filesystem::path &path);
[[nodiscard]] Expected<RawMesh> readVtp(const std::filesystem::path &path);
[[nodiscard]] Expected<RawMesh> readWithAssimp(const std::filesystem::path &path);

}  // namespace c3de::geometry
