// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What of an image does not go with the bodies beside it: bone, air, or all that belongs to no body.
struct StillRule {
  std::optional<double> above, below;  ///< values of the image beyond which a voxel stays
  std::vector<std::uint16_t> labels;   ///< of a label map, that stay
  bool outside = false;                ///< all that belongs to no body

  [[nodiscard]] bool isEmpty() const { return !above && !below && labels.empty() && !outside; }
  friend bool operator==(const StillRule &, const StillRule &) = default;
};

/// Marks the voxels that stay as kStillVoxel; those of bodies (kBodyVoxel) are left as they are.
/// @param labels  on a grid of its own; null: none
/// @param places  DisplacementGrid::bodies, on the grid of the image
/// Errors: usage, when `places` is on another grid.
[[nodiscard]] Expected<void> markStill(const StillRule &rule, const Volume &image, const LabelMap *labels,
                                       Mask &places);

/// Marks the voxels whose centres lie in a label of a map as kRigidVoxel, where it is one of `rigid`, else as
/// kBodyVoxel, whatever they were.
/// @param tissues    on a grid of its own
/// @param placement  of that grid in the world
void markTissues(const LabelMap &tissues, const Mat4 &placement, std::span<const std::uint16_t> rigid, Mask &places);
/// DisplacementGrid::hasStill of these places.
[[nodiscard]] bool holdsStill(const Mask &places);

}  // namespace c3de::imaging
