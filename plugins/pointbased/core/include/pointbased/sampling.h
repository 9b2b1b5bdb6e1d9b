// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// The body to fill, as questions that can be asked about it; the library reads no meshes.
struct BodyShape {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< bounds, m
  double volume = 0.0;                          ///< m³, > 0
  /// About 1 for points inside and 0 outside (a winding number); called with many points at once.
  std::function<void(std::span<const Vec3> points, std::span<double> inside)> inside;
  /// Distance to the surface, m, >= 0. Empty: contact radii from the volumes.
  std::function<void(std::span<const Vec3> points, std::span<double> distances)> surfaceDistance;
  /// Whether the straight way between two points inside crosses the surface (a gap thinner than the points are apart).
  /// Empty: never.
  std::function<void(std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses)> crosses;
  /// For bodies that know their contents better than their border (voxels): the part, 0 … 1, that is inside of cubes with
  /// edges of `edge` along the columns of a rotation, and about the signed distance of their middles from the border, m,
  /// negative inside (as many as there are cubes, or none are wanted). Empty: parts follow from surfaceDistance.
  std::function<void(std::span<const Vec3> middles, const Mat3 &axes, double edge, std::span<double> parts,
                     std::span<double> distances)> shares;
  /// The border itself, world, m; empty: supports and loads on surfaces are not possible.
  Surface surface;
};

struct Sampling {
  double spacing = 0.0;  ///< of the lattice, m; 0: from count
  std::size_t count = 1000;
};

/// Phyxels of a body, sorted in space.
struct PhyxelCloud {
  double spacing = 0.0;               ///< m
  std::vector<Vec3> positions;        ///< m
  std::vector<double> volumes;        ///< m³; their sum is the body's volume
  std::vector<double> contactRadii;   ///< m: distance to the surface, at most half a spacing
  double countedVolume = 0.0;         ///< m³, of what was found inside, before it was scaled; 0: nobody has counted
};

/// False: stop, somebody cancelled.
using SamplingProgress = std::function<bool(double fraction)>;

inline constexpr std::size_t kMaximumPhyxels = 2'000'000;

/// Phyxels on a regular lattice inside the body, each with the volume of the part of the body that is nearest to it.
///
/// The part is measured by counting points of a finer lattice inside the body; those near the surface are asked for, the
/// rest follows from their cell. Parts that no lattice point reaches (a lobe thinner than the spacing) get a phyxel at
/// their centroid, so nothing of the body is without mass. Volumes are then scaled to sum to the body's volume exactly.
///
/// Errors: spacing or count out of range, more than kMaximumPhyxels, nothing inside, cancelled.
[[nodiscard]] Result<PhyxelCloud> fill(const BodyShape &shape, const Sampling &sampling, const ParallelFor &parallelFor,
                                       const SamplingProgress &progress = {});

}  // namespace pointbased
