// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

/// Masks by hand: brush strokes, region growing and interpolation between slices. Results are on the grid of the mask.
/// Functions with a ProgressFn return ErrorCode::cancelled when it requests that; invalid arguments are
/// ErrorCode::usage. Any thread.
namespace c3de::imaging {

/// Closed range of image values.
struct ValueLimits {
  double low = 0.0, high = 0.0;
};

/// One drag of a brush. Positions are world coordinates, LPS mm.
struct BrushStroke {
  std::vector<Vec3> path;             ///< centres of the brush, joined by straight lines; a single one for a click
  double radius_mm = 5.0;             ///< > 0
  bool isErasing = false;             ///< otherwise voxels are added
  std::optional<Vec3> normal;         ///< unit normal of the slice that is painted, one voxel thick; none: balls
  std::optional<ValueLimits> values;  ///< of the image at the voxels that may change; none: all
};

/// Adds or removes the voxels whose centre is within the radius of the path. The voxels that contain points of the path
/// always belong to it, however small the radius.
/// @param image  needed for `values`; read at the nearest voxel, so its grid may differ from that of the mask
/// Errors: a path without points or with one that is not finite, a radius that is not > 0 and finite, `values` without
/// an image.
[[nodiscard]] Expected<void> paint(Mask &mask, const BrushStroke &stroke, const Volume *image);

/// The connected voxels around a point whose values differ from the value there by at most the tolerance.
/// @param maxDistance_mm  from the point; 0: unlimited
/// Errors: a point outside the image, a tolerance or a distance that is not >= 0 and finite.
[[nodiscard]] Expected<Mask> regionAround(const Volume &volume, const Vec3 &world, double tolerance,
                                          double maxDistance_mm, const ProgressFn &progress = {});

/// Fills the empty slices between slices that contain voxels, along one axis of the grid. Signed distances to the
/// outlines of the two neighbouring slices are interpolated linearly (shape-based interpolation: Raya and Udupa, IEEE
/// Trans. Med. Imaging 9, 1990). Outlines that do not overlap are first moved onto each other by their centroids.
/// Errors: no empty slice between two others along the axis.
[[nodiscard]] Expected<Mask> filledBetweenSlices(const Mask &mask, std::size_t axis, const ProgressFn &progress = {});
/// Empty slices between slices that contain voxels, along each axis of the grid.
[[nodiscard]] std::array<std::size_t, 3> emptySlicesBetween(const Mask &mask);

/// The axis of the grid that is closest to a direction.
[[nodiscard]] std::size_t axisAlong(const VolumeGeometry &grid, const Vec3 &direction);

/// The mask on another grid, by the nearest voxel; outside of its own grid it is empty.
[[nodiscard]] Mask onGrid(const Mask &mask, const VolumeGeometry &grid);

/// The map with a mask as one of its labels. Voxels of that label outside of the mask become background, other labels
/// are replaced inside of it.
/// @param before  null: the mask alone. Its grid must be that of the mask (ErrorCode::usage)
/// @param label  value, name and colour; 0 as value: the lowest that is not used
/// Errors: no value is free.
[[nodiscard]] Expected<LabelMap> withLabel(const LabelMap *before, const Mask &mask, LabelMap::Label label);

}  // namespace c3de::imaging
