// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pointbased/body_shape.h"
#include "pointbased/region.h"

namespace pointbased {

/// Fraction of every voxel of a regular grid that belongs to a body. A view: shapeOf() copies what it needs.
struct Occupancy {
  std::array<std::size_t, 3> size{};  ///< voxels along i, j, k
  /// [size[2]][size[1]][size[0]] 0 … 1, i fastest; outside of the grid nothing is filled
  std::span<const float> fill;
  Vec3 origin = Vec3::Zero();  ///< world, m: centre of voxel (0, 0, 0)
  /// Columns: from a voxel to the next along i, j, k, m; any direction, handedness, shear
  Mat3 steps = Mat3::Identity();
};

/// The body represented by an occupancy, without a mesh: a shape for fillLattice(), fill() and buildRestState().
///
/// Its volume is Σ fill times the volume of a voxel. A voxel is filled uniformly, so a cell or subcell of a lattice
/// counts with the integral of the fill over it (BodyShape::shares): exact where the lattice is aligned with the
/// voxels, otherwise by 4³ to 8³ points. Voxels smaller than a sixteenth of a cell (along the lattice; otherwise an
/// eighth) are combined into blocks with their mean. A voxel is inside if its fill is above one half.
///
/// Distances are measured to the nearest voxel whose state (filled or empty) differs from that around the point; 0 in
/// partially filled voxels. They are exact within a voxel of the border of a grid with orthogonal steps, otherwise
/// lower bounds. A segment between two points crosses the border if no face-connected voxels, filled at least half as
/// much as both ends, join them near the segment: gaps of one empty voxel separate, staircases do not.
///
/// @param surface  world, m: the skin, for surfels, contact, supports and loads; a smooth one around the same voxels.
///                 May be empty, as in BodyShape
/// Errors: a size that does not match the fill, values outside of 0 … 1, steps that span no volume, nothing filled.
///
/// Memory: 8 bytes per voxel of the filled part of the grid. Time: 0.1 µs per voxel on one thread.
[[nodiscard]] Result<BodyShape> shapeOf(const Occupancy &occupancy, Surface surface = {},
                                        const ParallelFor &parallelFor = serialFor());

/// The part that is filled by more than half, as a region; distances as in shapeOf(). Errors, memory and time as for
/// shapeOf().
[[nodiscard]] Result<Region> regionOf(const Occupancy &occupancy, const ParallelFor &parallelFor = serialFor());

}  // namespace pointbased
