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

/// Masks: made from images and label maps, mended, counted. Every result lies on the grid of what it was made from.
///
/// Voxels are neighbours where they share a face. Functions with a ProgressFn return ErrorCode::cancelled when it says
/// so, and ErrorCode::usage for what the caller got wrong; a mask whose voxels do not fit its geometry is
/// ErrorCode::internal. Any thread.
namespace c3de::imaging {

/// Voxels with low <= value <= high; values that are not numbers are outside. Errors: limits that are no numbers, low
/// above high.
[[nodiscard]] Expected<Mask> threshold(const Volume &volume, double low, double high, const ProgressFn &progress = {});

/// Voxels of one label, or of any of several; 0 is the background.
[[nodiscard]] Mask maskOf(const LabelMap &labels, std::uint16_t value);
[[nodiscard]] Mask maskOf(const LabelMap &labels, std::span<const std::uint16_t> values);

/// Voxels whose centre lies inside of a closed surface (world, mm). Rays along i count its faces, so either orientation
/// is right; parts that lie within each other are hollow, parts that overlap are, too, where they do.
[[nodiscard]] Mask maskOf(const geometry::TriangleMesh &closed, const VolumeGeometry &grid);

[[nodiscard]] std::size_t voxelCount(const Mask &mask);
/// Voxel count times voxel volume, mm³.
[[nodiscard]] double volumeOf(const Mask &mask);

/// How much of every voxel of a grid is inside.
struct Fill {
  VolumeGeometry geometry;
  std::vector<float> values;  ///< 0 … 1, geometry.voxelCount(), i fastest; the outermost layer is 0
};
/// The part of the grid that the mask covers, in blocks of whole voxels with edges up to `coarsest_mm` (0: single
/// voxels). Sums times voxel volumes are those of the mask. Errors: an empty mask, an edge that is not finite and >= 0.
[[nodiscard]] Expected<Fill> fillOf(const Mask &mask, double coarsest_mm = 0.0);

/// What hangs together with the voxel at `index`. Errors: an index outside of the grid or of the mask.
[[nodiscard]] Expected<Mask> connectedComponent(const Mask &mask, const std::array<std::size_t, 3> &index,
                                                const ProgressFn &progress = {});
/// The component with the most voxels, the first of those that have as many; an empty mask stays empty.
[[nodiscard]] Expected<Mask> largestComponent(const Mask &mask, const ProgressFn &progress = {});
/// Sizes of all components in voxels, largest first.
[[nodiscard]] Expected<std::vector<std::size_t>> componentSizes(const Mask &mask, const ProgressFn &progress = {});
/// With the voxels outside from which no way through faces leads to the border of the grid.
[[nodiscard]] Expected<Mask> fillHoles(const Mask &mask, const ProgressFn &progress = {});

/// Closing: gaps and bays narrower than twice the radius are filled; the mask may grow towards the border of the grid,
/// not beyond it. Balls are exact in millimetres between voxel centres, whatever the spacing, direction or shear.
/// Errors: a radius that is not > 0 and finite, or more than 128 voxels.
[[nodiscard]] Expected<Mask> closed(const Mask &mask, double radius_mm, const ProgressFn &progress = {});
/// Opening: bridges and spurs narrower than twice the radius are removed. The border of the grid takes nothing off:
/// what it cuts goes on behind it. Errors as of closed().
[[nodiscard]] Expected<Mask> opened(const Mask &mask, double radius_mm, const ProgressFn &progress = {});

/// The voxels within a distance of one of the mask, which stays. Errors as of closed().
[[nodiscard]] Expected<Mask> grown(const Mask &mask, double radius_mm, const ProgressFn &progress = {});

/// What makes the mask of an organ of raw voxels, in this order; 0 and false: not wanted.
struct Mending {
  double opening_mm = 0.0, closing_mm = 0.0;
  bool largest = false, fillHoles = false;
};
[[nodiscard]] Expected<Mask> mended(Mask mask, const Mending &how, const ProgressFn &progress = {});

/// Labels on another grid: each voxel takes the label at its centre, 0 where the map has none. Errors: a grid without
/// voxels.
[[nodiscard]] Expected<LabelMap> resampled(const LabelMap &labels, const VolumeGeometry &grid,
                                           const ProgressFn &progress = {});

}  // namespace c3de::imaging
