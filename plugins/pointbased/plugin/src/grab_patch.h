// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pointbased/body.h"

namespace pointbased {

struct PinchSettings {
  double frequency_hz = 25.0;  ///< of the spring on the mass it holds
  double dampingRatio = 1.0;
  double radius_mm = 18.0;    ///< of the patch around the surfel; at least two spacings are taken
  double largestForce = 0.0;  ///< N; 0: what strains the patch by several hundred per cent, which is never exceeded
};

/// The phyxels within a radius, m, of a point, measured at rest, weighted towards the middle; maybe none. Those that a
/// fix holds are left out.
/// @param at  m, in the frame of the phyxels
[[nodiscard]] Grab patchAround(const RestState &rest, const Vec3 &at, double radius);
/// The same; those that a surfel is bound to when none is so near.
[[nodiscard]] Grab patchAround(const RestState &rest, const Vec3 &at, double radius, std::size_t surfel);
/// A hold on a surfel: the patch around it, and a spring that strains it by several hundred per cent at most. The
/// target is for the caller to set.
[[nodiscard]] Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings,
                              double youngsModulus);
/// The same of a point inside; holds nothing where a fix holds all around it.
/// @param at  m, in the frame of the phyxels
[[nodiscard]] Grab grabAt(const RestState &rest, const Vec3 &at, const PinchSettings &settings, double youngsModulus);

/// Limits a hold, which was made with the modulus of a body's first material, to what the tissue bears that it holds:
/// soft parts count for the most, since they give way first.
/// @param ownLimit  N, of PinchSettings::largestForce; 0: none
void limitToTissue(Grab &grab, const Body &body, double ownLimit);

/// What of a body is at a place now.
struct MaterialPoint {
  Vec3 at = Vec3::Zero();  ///< m, in the reference, frame of the phyxels
  bool isHeld = false;     ///< by a fix
};
/// By the phyxels around it, which must surround it more or less: exact where the body has been turned and stretched
/// evenly. Nothing: the body has no phyxels.
/// @param phyxels  [phyxels] world, m, where they are now
/// @param place    world, m
[[nodiscard]] std::optional<MaterialPoint> materialAt(const RestState &rest, std::span<const Vec3> phyxels,
                                                      const Vec3 &place);
/// Of which material a body is at a point of its reference, frame of the phyxels: by its regions, and within a tenth of
/// a spacing of one; 0 where none is.
[[nodiscard]] std::uint16_t materialNumberAt(const RestState &rest, const Vec3 &at);
/// Every phyxel gets a spring of its own, to where it is now: what is held keeps its shape. The target becomes the mean
/// of what is held, world, m, which is returned.
Vec3 keepShape(Grab &grab, const Body &body);
/// Where the mean is now, world, m.
[[nodiscard]] Vec3 middleOf(const Grab &grab, const Body &body);

}  // namespace pointbased
