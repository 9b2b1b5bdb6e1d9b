// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body.h"

namespace pointbased {

struct PinchSettings {
  double frequency_hz = 25.0;  ///< of the spring on the mass it holds
  double dampingRatio = 1.0;
  double radius_mm = 18.0;    ///< of the patch around the surfel; at least two spacings are taken
  double largestForce = 0.0;  ///< N; 0: what strains the patch by several hundred per cent, which is never exceeded
};

/// The phyxels within a radius, m, of a point, measured at rest, weighted towards the middle; those that a surfel is
/// bound to when none is so near. Those that a fix holds are left out.
/// @param at  m, in the frame of the phyxels
[[nodiscard]] Grab patchAround(const RestState &rest, const Vec3 &at, double radius, std::size_t surfel);
/// A hold on a surfel: the patch around it, and a spring that strains it by several hundred per cent at most. The
/// target is for the caller to set.
[[nodiscard]] Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings,
                              double youngsModulus);
/// Every phyxel gets a spring of its own, to where it is now: what is held keeps its shape. The target becomes the mean
/// of what is held, world, m, which is returned.
Vec3 keepShape(Grab &grab, const Body &body);
/// Where the mean is now, world, m.
[[nodiscard]] Vec3 middleOf(const Grab &grab, const Body &body);

}  // namespace pointbased
