// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "c3de/imaging/masks.h"

namespace c3de::session {

/// How much of the requested part of an image a body represents.
struct Coverage {
  std::string body;
  double requested_mm3 = 0.0, missing_mm3 = 0.0;  ///< volume of voxels
  std::size_t specks = 0;                         ///< islands too small to be simulated; part of the missing volume
  std::shared_ptr<const imaging::Mask> missing;   ///< on the grid of the mask; null: nothing is missing
  [[nodiscard]] double part() const { return requested_mm3 > 0.0 ? 1.0 - missing_mm3 / requested_mm3 : 1.0; }
};

/// The part of a mask that a closed skin does not enclose.
/// @param specks  specks of `asked` that were removed before
[[nodiscard]] Coverage coverageOf(const imaging::Mask &asked, const geometry::TriangleMesh &skin, std::size_t specks);
/// The part of a mask that the voxels of a body do not fill. @param filled  on the grid of `asked`
[[nodiscard]] Coverage coverageOf(const imaging::Mask &asked, const imaging::Mask &filled, std::size_t specks);

/// "12.3 ml (4.5 %) of the volume requested as 'aorta' belongs to no body; …", with advice. Empty where the missing
/// part is negligible: less than a thousandth.
[[nodiscard]] std::string sentenceOf(const Coverage &coverage);

/// All missing voxels on one grid. The mask is empty where nothing is missing, or nothing within the grid.
[[nodiscard]] imaging::Mask missingOn(const imaging::VolumeGeometry &grid, const std::vector<Coverage> &bodies);

}  // namespace c3de::session
