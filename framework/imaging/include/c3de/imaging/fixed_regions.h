// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// The part of an image that does not move with the bodies: bone, air, or everything outside the bodies.
struct FixedRegionRule {
  std::optional<double> above, below;  ///< image values beyond which a voxel is fixed
  std::vector<std::uint16_t> labels;   ///< of a label map, fixed
  bool outside = false;                ///< everything outside the bodies

  [[nodiscard]] bool isEmpty() const { return !above && !below && labels.empty() && !outside; }
  friend bool operator==(const FixedRegionRule &, const FixedRegionRule &) = default;
};

/// Marks the fixed voxels as kFixedVoxel; voxels of bodies (kBodyVoxel) are left unchanged.
/// @param labels  on its own grid; null: none
/// @param places  DisplacementGrid::bodies, on the grid of the image
/// Errors: usage, when `places` is on another grid.
[[nodiscard]] Expected<void> markFixedRegions(const FixedRegionRule &rule, const Volume &image, const LabelMap *labels,
                                              Mask &places);

/// Marks the voxels whose centres are in a label of a map as kRigidVoxel if the label is in `rigid`, otherwise as
/// kBodyVoxel, whatever their previous value.
/// @param tissues    on its own grid
/// @param placement  of that grid in the world
void markTissues(const LabelMap &tissues, const Mat4 &placement, std::span<const std::uint16_t> rigid, Mask &places);
/// The value of DisplacementGrid::hasFixedRegions for this mask.
[[nodiscard]] bool hasFixedVoxels(const Mask &places);

}  // namespace c3de::imaging
