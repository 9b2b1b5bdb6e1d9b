// SPDX-License-Identifier: Apache-2.0
// Obstacles by formula that bodies are squeezed through or collect in.
#pragma once

#include "pointbased/obstacle.h"

namespace shapes {

/// A torus about the y axis.
/// @param radius  m, of the circle in the middle of the tube
/// @param tube    m, radius of the tube
[[nodiscard]] pointbased::Obstacle torus(const pointbased::Vec3 &centre, double radius, double tube, double friction);
/// m, negative inside of it.
[[nodiscard]] double distanceToTorus(const pointbased::Vec3 &x, const pointbased::Vec3 &centre, double radius,
                                     double tube);
/// The half-space y < 0 with a hollow half sphere about the origin.
[[nodiscard]] pointbased::Obstacle bowl(double radius, double friction);

}  // namespace shapes
