// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/geometry/triangle_mesh.h"
#include "c3de/imaging/volume.h"

/// Masks: creation from images and label maps, repair, measurement. Every result is on the grid of its input.
///
/// Neighbouring voxels share a face. Functions with a ProgressFn return ErrorCode::cancelled when it requests that, and
/// ErrorCode::usage for invalid arguments; a mask whose voxels do not match its geometry is ErrorCode::internal. Any
/// thread.
namespace c3de::imaging {

/// Voxels with low <= value <= high; NaN values are outside. Errors: NaN limits, low above high.
[[nodiscard]] Expected<Mask> threshold(const Volume &volume, double low, double high, const ProgressFn &progress = {});

/// Voxels of one label, or of any of several; 0 is the background.
[[nodiscard]] Mask maskOf(const LabelMap &labels, std::uint16_t value);
[[nodiscard]] Mask maskOf(const LabelMap &labels, std::span<const std::uint16_t> values);

/// Voxels whose centre is inside a closed surface (world, mm). Rays along i count its faces, so either orientation is
/// valid. The interior of nested parts is hollow, and so is the intersection of overlapping parts.
[[nodiscard]] Mask maskOf(const geometry::TriangleMesh &closed, const VolumeGeometry &grid);

[[nodiscard]] std::size_t voxelCount(const Mask &mask);
/// Voxel count times voxel volume, mm³.
[[nodiscard]] double volumeOf(const Mask &mask);

/// The fraction of every voxel of a grid that is inside.
struct Fill {
  VolumeGeometry geometry;
  std::vector<float> values;  ///< 0 … 1, geometry.voxelCount(), i fastest; the outermost layer is 0
};
/// The part of the grid that the mask covers, in blocks of whole voxels with edges up to `coarsest_mm` (0: single
/// voxels). Sums times voxel volumes equal those of the mask. Errors: an empty mask, an edge that is not finite and >=
/// 0.
[[nodiscard]] Expected<Fill> fillOf(const Mask &mask, double coarsest_mm = 0.0);

/// The component of the voxel at `index`. Errors: an index outside the grid or the mask.
[[nodiscard]] Expected<Mask> connectedComponent(const Mask &mask, const std::array<std::size_t, 3> &index,
                                                const ProgressFn &progress = {});
/// The component with the most voxels, the first one if several are equally large; an empty mask stays empty.
[[nodiscard]] Expected<Mask> largestComponent(const Mask &mask, const ProgressFn &progress = {});
/// Sizes of all components in voxels, largest first.
[[nodiscard]] Expected<std::vector<std::size_t>> componentSizes(const Mask &mask, const ProgressFn &progress = {});
/// Adds the voxels outside the mask that have no path through faces to the border of the grid.
[[nodiscard]] Expected<Mask> fillHoles(const Mask &mask, const ProgressFn &progress = {});

/// Closing: fills gaps and bays narrower than twice the radius. The mask may grow up to the border of the grid, but not
/// beyond. Balls are exact in millimetres between voxel centres, whatever the spacing, direction or shear. Errors: a
/// radius that is not > 0 and finite, or more than 128 voxels.
[[nodiscard]] Expected<Mask> closed(const Mask &mask, double radius_mm, const ProgressFn &progress = {});
/// Opening: removes bridges and spurs narrower than twice the radius. The border of the grid removes nothing, as if the
/// mask continued beyond it. Errors as for closed().
[[nodiscard]] Expected<Mask> opened(const Mask &mask, double radius_mm, const ProgressFn &progress = {});

/// Dilation: adds the voxels within a distance of the mask. Errors as for closed().
[[nodiscard]] Expected<Mask> grown(const Mask &mask, double radius_mm, const ProgressFn &progress = {});

/// Steps that make a clean organ mask from raw voxels, in this order; 0 and false: skip.
struct MaskCleanUp {
  double opening_mm = 0.0, closing_mm = 0.0;
  bool largest = false, fillHoles = false;
};
[[nodiscard]] Expected<Mask> mended(Mask mask, const MaskCleanUp &how, const ProgressFn &progress = {});

/// Labels on another grid: each voxel gets the label at its centre, 0 where the map has none. Errors: a grid without
/// voxels.
[[nodiscard]] Expected<LabelMap> resampled(const LabelMap &labels, const VolumeGeometry &grid,
                                           const ProgressFn &progress = {});

}  // namespace c3de::imaging
