// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/surface.h"
#include "pointbased/types.h"

namespace pointbased {

/// The body to be filled, as query functions; the library reads no meshes.
struct BodyShape {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< bounds, m
  double volume = 0.0;                          ///< m³, > 0
  /// About 1 for points inside and 0 outside (a winding number); called with many points at once.
  std::function<void(std::span<const Vec3> points, std::span<double> inside)> inside;
  /// Distance to the surface, m, >= 0. Empty: contact radii from the volumes.
  std::function<void(std::span<const Vec3> points, std::span<double> distances)> surfaceDistance;
  /// Whether the straight segment between two points inside crosses the surface (a gap thinner than the distance of the
  /// points). Empty: never.
  std::function<void(std::span<const Vec3> from, std::span<const Vec3> to, std::span<std::uint8_t> crosses)> crosses;
  /// For bodies that define their contents better than their border (voxels). Fraction, 0 … 1, inside of each cube with
  /// edges of `edge` along the columns of a rotation, and approximate signed distance of the cube centres from the
  /// border, m, negative inside (one per cube, or none if they are not requested). Empty: fractions are derived from
  /// surfaceDistance.
  std::function<void(std::span<const Vec3> middles, const Mat3 &axes, double edge, std::span<double> parts,
                     std::span<double> distances)>
      shares;
  /// The border, world, m; empty: supports and loads on surfaces are not possible.
  Surface surface;
};

}  // namespace pointbased
