// SPDX-License-Identifier: Apache-2.0
// Closed surfaces by formulas, most of thin bodies, whose lowest point is at y = 0. Metres.
#pragma once

#include <functional>

#include "pointbased/surface.h"

namespace validation {

/// Rings of vertices from one pole (ring 0) to the other (ring `rings`), which are single vertices.
/// @param at  position of a vertex of a ring, by its angle
[[nodiscard]] pointbased::Surface latheSurface(int rings, int around,
                                               const std::function<pointbased::Vec3(int ring, double phi)> &at);
/// Hollow, along x: outer radius, wall, length.
[[nodiscard]] pointbased::Surface tubeSurface(double radius, double wall, double length);
/// Horizontal: edge by thickness by edge.
[[nodiscard]] pointbased::Surface sheetSurface(double edge, double thickness);
/// An upright torus: radius of the ring and of its section.
[[nodiscard]] pointbased::Surface ringSurface(double radius, double section);
/// A round wire wound about y.
[[nodiscard]] pointbased::Surface helixSurface(double radius, double section, double pitch, int turns);
/// Square fingers, as wide as the gaps between them, that hang down from a beam twice as high.
[[nodiscard]] pointbased::Surface combSurface(int fingers, double width, double length);
/// A ball with spikes in seven directions: reach of the spikes, radius of the ball.
[[nodiscard]] pointbased::Surface starSurface(double reach, double radius);

}  // namespace validation
