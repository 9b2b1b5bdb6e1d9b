// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "c3de/imaging/masks.h"

namespace c3de::session {

/// What of the part of an image that was asked for a body stands for.
struct Coverage {
  std::string body;
  double asked_mm3 = 0.0, missing_mm3 = 0.0;     ///< of voxels
  std::size_t specks = 0;                        ///< of what is missing: islands too small to be simulated
  std::shared_ptr<const imaging::Mask> missing;  ///< on the grid of the mask; null: nothing
  [[nodiscard]] double part() const { return asked_mm3 > 0.0 ? 1.0 - missing_mm3 / asked_mm3 : 1.0; }
};

/// What a closed skin leaves of a mask outside.
/// @param specks  of `asked` that were left out before
[[nodiscard]] Coverage coverageOf(const imaging::Mask &asked, const geometry::TriangleMesh &skin, std::size_t specks);
/// What voxels that fill a body leave of it. @param filled  on the grid of `asked`
[[nodiscard]] Coverage coverageOf(const imaging::Mask &asked, const imaging::Mask &filled, std::size_t specks);

/// "12.3 ml (4.5 %) of what was asked for as 'aorta' is in no body; …", with what would help; empty where nothing is
/// missing that a person would want to know: less than a thousandth.
[[nodiscard]] std::string sentenceOf(const Coverage &coverage);

/// All that is missing, on one grid; an empty mask where nothing is, or nothing that lies in it.
[[nodiscard]] imaging::Mask missingOn(const imaging::VolumeGeometry &grid, const std::vector<Coverage> &bodies);

}  // namespace c3de::session
