// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Closer than this share of the diagonal counts as equal: far above rounding, far below any feature.
inline constexpr double kWeldTolerance = 1e-9;

/// The steps of the clean-up, in this order. Each changes the mesh and adds a sentence to `repairs` if it did
/// something.
/// @pre  indices in range, coordinates finite
void weldVertices(TriangleMesh &mesh, std::vector<std::string> &repairs);
/// Triangles without area. One with three different corners lies on a line, and removing it would tear the surface: the
/// neighbour across its longest side is split at its middle corner instead, which is the flip of that side.
void removeDegenerateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs);
/// Of triangles with the same corners one stays; two that face opposite ways bound nothing and both go, except where
/// the whole surface is two-sided.
void removeDuplicateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs);
void removeUnusedVertices(TriangleMesh &mesh, std::vector<std::string> &repairs);

/// Makes neighbours face the same way where that is possible, then turns closed parts that are inside out. A part
/// within another (a cavity, a tumour) keeps its sense relative to the outermost one around it.
void orient(TriangleMesh &mesh, std::vector<std::string> &repairs);

/// No area within the weld tolerance: a repeated corner, or three corners on a line.
[[nodiscard]] bool isDegenerate(const TriangleMesh &mesh, const Triangle &triangle, double diagonal_mm);

}  // namespace c3de::geometry
