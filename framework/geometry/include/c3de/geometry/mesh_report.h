// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// Properties and defects of a mesh.
struct MeshReport {
  std::size_t vertices = 0, triangles = 0, components = 0;
  std::size_t boundaryEdges = 0;     ///< edges with one triangle; 0 = closed
  std::size_t nonManifoldEdges = 0;  ///< edges with more than two triangles
  std::size_t misorientedEdges = 0;  ///< edges whose two triangles have the same direction
  std::size_t degenerateTriangles = 0;
  bool closed = false, manifold = false, oriented = false;
  bool insideOut = false;   ///< closed and oriented, but the signed volume is negative
  double volume_mm3 = 0.0;  ///< signed
  double area_mm2 = 0.0;
  Box box;                                   ///< mm
  LengthUnit unit = LengthUnit::millimetre;  ///< assumed when the file was read
  std::vector<std::string> repairs;          ///< changes, a sentence each
  std::vector<std::string> warnings;  ///< issues to be checked by the user, a sentence each (for example: 300 m wide)

  [[nodiscard]] std::string text() const;  ///< several lines for display, every number with its unit
  [[nodiscard]] std::string json() const;  ///< for `c3de info --json`
};

/// Only inspects; changes nothing. Vertices at equal positions count as one for edges and components.
/// @param unit  the unit assumed when the mesh was read, for the hints; the vertices are in mm
[[nodiscard]] MeshReport inspect(const TriangleMesh &mesh, LengthUnit unit);

/// Whether the mesh bounds a volume that can be filled: finite, sufficiently closed, not flat, not as long as a
/// building. Small holes are allowed, because inside is where the winding number is above one half. The error states
/// the defect and the remedy; warnings about a usable mesh stay in the report.
[[nodiscard]] Expected<void> checkFillable(const TriangleMesh &mesh, const MeshReport &report);

}  // namespace c3de::geometry
