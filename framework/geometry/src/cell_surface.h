// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "raw_mesh.h"

namespace c3de::geometry {

/// The outer surface of a mesh of cells with VTK cell types and corner numbering: faces that belong to one cell only,
/// oriented outwards. If there are no volume cells, the cells that are faces. For cells with points on their edges only
/// the corners are used.
class CellSurface {
 public:
  /// @param corners  indices of points, in range. Errors (input): an unknown type, too few corners
  [[nodiscard]] Expected<void> add(long long type, std::span<const unsigned> corners);
  /// Adds the surface to a mesh, which must contain all vertices, and notes omissions.
  [[nodiscard]] Expected<void> finish(RawMesh &raw) const;

 private:
  struct Cell {
    int type;  ///< of the cell with straight edges
    std::size_t begin, end;
  };
  std::vector<Cell> volumes_, faces_;
  std::vector<unsigned> corners_;
  std::size_t pointsAndLines_ = 0, curved_ = 0;
};

}  // namespace c3de::geometry
