// SPDX-License-Identifier: Apache-2.0
// Obstacles by formula: a ring to squeeze bodies through and a bowl to collect them.
#pragma once

#include "pointbased/obstacle.h"

namespace shapes {

/// A torus about the y axis.
/// @param radius  m, of the centre line of the tube
/// @param tube    m, radius of the tube
[[nodiscard]] pointbased::Obstacle torus(const pointbased::Vec3 &centre, double radius, double tube, double friction);
/// m, negative inside.
[[nodiscard]] double distanceToTorus(const pointbased::Vec3 &x, const pointbased::Vec3 &centre, double radius,
                                     double tube);
/// The half-space y < 0 with a hemispherical hollow about the origin.
[[nodiscard]] pointbased::Obstacle bowl(double radius, double friction);

}  // namespace shapes
