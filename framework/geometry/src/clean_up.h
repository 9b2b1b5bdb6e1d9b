// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// A distance below this fraction of the diagonal counts as equal: far above rounding, far below any feature.
inline constexpr double kWeldTolerance = 1e-9;

/// The clean-up steps, in this order. Each modifies the mesh and adds a sentence to `repairs` if it changed anything.
/// @pre  indices in range, coordinates finite
void weldVertices(TriangleMesh &mesh, std::vector<std::string> &repairs);
/// Removes triangles without area. Removing one with three different corners on a line would open the surface: instead
/// the neighbour across its longest side is split at its middle corner, which is the flip of that side.
void removeDegenerateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs);
/// Keeps one of several triangles with the same corners. Two that face opposite ways bound nothing and are both
/// removed, except where the whole surface is two-sided.
void removeDuplicateTriangles(TriangleMesh &mesh, std::vector<std::string> &repairs);
void removeUnusedVertices(TriangleMesh &mesh, std::vector<std::string> &repairs);

/// Orients neighbours consistently where possible, then flips closed parts that are inside out. A part within another
/// (a cavity, a tumour) keeps its orientation relative to the outermost one around it.
void orient(TriangleMesh &mesh, std::vector<std::string> &repairs);

/// No area within the weld tolerance: a repeated corner, or three corners on a line.
[[nodiscard]] bool isDegenerate(const TriangleMesh &mesh, const Triangle &triangle, double diagonal_mm);

}  // namespace c3de::geometry
