// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "raw_mesh.h"

namespace c3de::geometry {

/// The outer surface of a mesh of cells, as VTK numbers their types and corners: faces that one cell alone has, turned
/// outwards. Where there are no cells with a volume, the cells that are faces themselves. Of cells with points on their
/// edges the corners are taken.
class CellSurface {
 public:
  /// @param corners  indices of points, in range. Errors (input): a type that is not known, too few corners
  [[nodiscard]] Expected<void> add(long long type, std::span<const unsigned> corners);
  /// Adds the surface to a mesh, whose vertices are all there, and notes what was left out.
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
