// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pointbased/body.h"

namespace pointbased {

struct PinchSettings {
  double frequency_hz = 25.0;  ///< of the spring with the mass it holds
  double dampingRatio = 1.0;
  double radius_mm = 18.0;    ///< of the patch around the surfel; at least two spacings are used
  double largestForce = 0.0;  ///< N; 0: the force that strains the patch by several hundred per cent, which is never
                              ///< exceeded
};

/// The phyxels within a radius, m, of a point, measured at rest, with weights that increase towards the centre. May be
/// empty. Phyxels held by a fix are excluded.
/// @param at  m, in the frame of the phyxels
[[nodiscard]] Grab patchAround(const RestState &rest, const Vec3 &at, double radius);
/// Same. If no phyxel is within the radius, returns the phyxels to which a surfel is bound.
[[nodiscard]] Grab patchAround(const RestState &rest, const Vec3 &at, double radius, std::size_t surfel);
/// A grab of a surfel: the patch around it, and a spring that strains it by several hundred per cent at most. The
/// caller sets the target.
[[nodiscard]] Grab grabAround(const RestState &rest, std::size_t surfel, const PinchSettings &settings,
                              double youngsModulus);
/// Same for an interior point. It has no phyxels where a fix holds everything around the point.
/// @param at  m, in the frame of the phyxels
[[nodiscard]] Grab grabAt(const RestState &rest, const Vec3 &at, const PinchSettings &settings, double youngsModulus);

/// Limits the force of a grab, created with the modulus of a body's first material, to the strength of the tissue it
/// holds. Soft parts have the largest weight, since they yield first.
/// @param ownLimit  N, of PinchSettings::largestForce; 0: none
void limitToTissue(Grab &grab, const Body &body, double ownLimit);

/// The material of a body that is now at a given position.
struct MaterialPoint {
  Vec3 at = Vec3::Zero();  ///< m, in the reference, frame of the phyxels
  bool isHeld = false;     ///< by a fix
};
/// Computed from the surrounding phyxels, which must enclose the position more or less. Exact where the body has been
/// rotated and stretched uniformly. Nothing if the body has no phyxels.
/// @param phyxels  [phyxels] world, m; present positions
/// @param position  world, m
[[nodiscard]] std::optional<MaterialPoint> materialAt(const RestState &rest, std::span<const Vec3> phyxels,
                                                      const Vec3 &position);
/// Number of the material at a point of the body's reference, frame of the phyxels. Determined by its regions, up to a
/// tenth of a spacing outside of one; 0 where there is none.
[[nodiscard]] std::uint16_t materialNumberAt(const RestState &rest, const Vec3 &at);
/// Attaches a separate spring to every phyxel at its present position, so that the held patch keeps its shape. The
/// target becomes the mean position of the held phyxels, world, m, which is returned.
Vec3 addShapeSprings(Grab &grab, const Body &body);
/// Present mean position of the held phyxels, world, m.
[[nodiscard]] Vec3 meanPosition(const Grab &grab, const Body &body);

}  // namespace pointbased
