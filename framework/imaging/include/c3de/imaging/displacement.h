// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// A spatial displacement: the material that is now at x was at x - u(x) in the reference image. Linear between the
/// points of the grid, zero outside; a millionth of a cell outside still counts as the border.
struct DisplacementGrid {
  VolumeGeometry geometry;
  std::vector<float> xyz_mm;  ///< 3 for each point, i fastest

  /// u at a point of the world, mm.
  [[nodiscard]] Vec3 at(const Vec3 &world) const;
};

}  // namespace c3de::imaging
