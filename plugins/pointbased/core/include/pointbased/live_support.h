// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "pointbased/supports.h"
#include "pointbased/types.h"

namespace pointbased {

struct RestState;

/// A support that is added to a body while it is simulated. The mean displacement of each patch of a part of the
/// surface is prescribed, as by ConstrainedRegion: it starts from `offsets` and is translated from `from` to `to`.
struct LiveSupport {
  ConstrainedRegion part;                       ///< rows, areas and centroid; no phyxels held directly
  std::vector<Vec3> offsets;                    ///< [rows] m, displacement from the first reference at `start`
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m, translation at `start` and after the ramp
  bool returns = false;                         ///< `offsets` are reduced to zero during the ramp
  double start = 0.0, ramp = 0.0;               ///< s, >= 0; a quasi-static solution has the load factor for time

  /// Fraction of the motion at time (or load factor) t. A quasi-static solution ends at load factor 1.
  [[nodiscard]] double progressAt(double t, bool quasiStatic) const {
    const double span = quasiStatic ? 1.0 - start : ramp;
    return span > 0.0 ? std::clamp((t - start) / span, 0.0, 1.0) : 1.0;
  }
  /// m, translation at a fraction s of the motion.
  [[nodiscard]] Vec3 displacementAt(double s) const { return from + s * (to - from); }
};

/// Creates the rows of a support from points on the surface. Points nearest to one phyxel make one row. Points whose
/// phyxels are all held already make none, so the support may be empty. Rows at the edge of the support, where the skin
/// continues, have kEdgePatchStiffness.
/// @param points         [points] first reference, frame of the phyxels, m
/// @param normals        [points] unit, outwards
/// @param areas          [points] m², > 0
/// @param displacements  [points] m, where the support starts
/// @param held           [phyxels] Body::heldMask()
[[nodiscard]] LiveSupport liveSupport(const RestState &rest, std::span<const Vec3> points,
                                      std::span<const Vec3> normals, std::span<const double> areas,
                                      std::span<const Vec3> displacements, std::span<const std::uint8_t> held);

}  // namespace pointbased
