// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What a voxel of DisplacementGrid::bodies shows in the reference; 0: what goes with the bodies beside it.
inline constexpr std::uint8_t kBodyVoxel = 1;  ///< a body
/// What stays, bone or air: a body may come over it, nothing else moves it
inline constexpr std::uint8_t kStillVoxel = 2;

/// A spatial displacement: the material that is now at x was at x - u(x) in the reference image. Linear between the
/// points of the grid, zero outside; a millionth of a cell outside still counts as the border.
///
/// Where a body has gone away the reference image still shows it, and u, which falls to nothing around bodies, leads
/// there. Such a place is vacated: X = x - u(x) lies in a body, and the gap at x is more than leastGap(). Outside of
/// the grid, which holds all bodies as they are now, everything that was a body has gone.
///
/// What stays is where the reference shows it: u is 0 there, unless X lies in a body, which has come over it. What was
/// beside it and has moved away by more than a quarter of leastGap(), so that X lies in what stays, leaves a gap:
/// vacated, too.
struct DisplacementGrid {
  VolumeGeometry geometry;
  std::vector<float> xyz_mm;    ///< 3 for each point, i fastest
  std::vector<float> gap_mm{};  ///< for each point, how far the material of X is from it now; empty: not known
  /// The reference, on a grid of its own: 0 or k…Voxel; null: nothing is vacated or stays
  std::shared_ptr<const Mask> bodies{};
  bool hasStill = false;  ///< kStillVoxel occurs

  /// u at a point of the world, mm; 0 in what stays.
  [[nodiscard]] Vec3 at(const Vec3 &world) const;
  /// Whether the tissue that the reference shows there has gone away and nothing has come.
  [[nodiscard]] bool isVacated(const Vec3 &world) const;
  [[nodiscard]] bool knowsVacated() const { return bodies != nullptr && !gap_mm.empty(); }
  /// Half the finest step, mm: the surface of a body is not known better.
  [[nodiscard]] double leastGap() const;
};

}  // namespace c3de::imaging
