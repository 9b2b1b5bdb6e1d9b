// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pointbased/body_shape.h"
#include "pointbased/region.h"

namespace pointbased {

/// How much of every voxel of a regular grid belongs to a body. A view: shapeOf() copies what it needs.
struct Occupancy {
  std::array<std::size_t, 3> size{};  ///< voxels along i, j, k
  /// [size[2]][size[1]][size[0]] 0 … 1, i fastest; beyond the grid nothing is filled
  std::span<const float> fill;
  Vec3 origin = Vec3::Zero();  ///< world, m: the middle of voxel (0, 0, 0)
  /// Columns: from a voxel to the next along i, j, k, m; any direction, handedness, shear
  Mat3 steps = Mat3::Identity();
};

/// The body that an occupancy stands for, without a mesh: a shape for fillLattice(), fill() and buildRestState().
///
/// Its volume is Σ fill times the volume of a voxel. A voxel is filled evenly, so a cell or a small cell of a lattice
/// counts with the integral of the fill over it (BodyShape::shares): exact where the lattice runs along the voxels, by
/// 4³ to 8³ points where it does not. Voxels smaller than a sixteenth of a cell (along the lattice; an eighth else) are
/// seen in blocks with their mean. A voxel lies inside from a fill above one half on.
///
/// Distances run to the nearest voxel that is not filled, or empty, like the one around the point; 0 in voxels filled
/// in part. They are exact within a voxel of the border of a grid with orthogonal steps, else at most what is true. A
/// way between two points crosses the border where no voxels with common faces lead from one to the other near it,
/// filled at least half as much as both ends: gaps of one empty voxel separate, staircases do not.
///
/// @param surface  world, m: the skin, for surfels, contact, supports and loads; a smooth one around the same voxels.
///                 May be empty, as in BodyShape
/// Errors: a size that does not fit the fill, values that are not 0 … 1, steps that span no volume, nothing filled.
/// Memory: 8 bytes per voxel of the part of the grid that is filled. Time: 0.1 µs per voxel on one thread.
[[nodiscard]] Result<BodyShape> shapeOf(const Occupancy &occupancy, Surface surface = {},
                                        const ParallelFor &parallelFor = serialFor());

/// What is filled by more than half, as a region; distances as in shapeOf(). Errors, memory and time as of shapeOf().
[[nodiscard]] Result<Region> regionOf(const Occupancy &occupancy, const ParallelFor &parallelFor = serialFor());

}  // namespace pointbased
