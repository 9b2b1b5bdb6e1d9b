// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::geometry {

enum class LengthUnit { metre, millimetre, centimetre };

/// Millimetres per unit.
[[nodiscard]] double millimetresPer(LengthUnit unit);
[[nodiscard]] const char *unitName(LengthUnit unit);  ///< "m", "mm", "cm"

/// An indexed triangle surface in the host's world unit, millimetres. Immutable once it is built.
struct TriangleMesh {
  std::vector<Vec3> vertices;       ///< mm
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside
};

struct Box {
  Vec3 min{}, max{};
};
[[nodiscard]] Box boundingBox(const TriangleMesh &mesh);
/// Signed volume by the divergence theorem, mm³; positive if the faces point outwards. An open surface is closed by
/// rays to the centre of its box.
[[nodiscard]] double signedVolume(const TriangleMesh &mesh);
[[nodiscard]] double surfaceArea(const TriangleMesh &mesh);  ///< mm²
/// Area-weighted unit normals per vertex; (0, 0, 1) where no triangle defines one.
[[nodiscard]] std::vector<Vec3> vertexNormals(const TriangleMesh &mesh);

}  // namespace c3de::geometry
