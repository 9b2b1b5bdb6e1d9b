// SPDX-License-Identifier: Apache-2.0
// Solids as functions that are negative inside, for make_organ and make_scan. Lengths in mm.
#pragma once

#include <cstddef>

#include "c3de/core/vec.h"

namespace c3de::tools {

/// About the distance to an ellipsoid, exact on its surface.
[[nodiscard]] double ellipsoid(const Vec3 &p, const Vec3 &centre, const Vec3 &radii);
/// The point that a rotation about an axis (0 x, 1 y, 2 z) through the centre by this angle maps to p: a shape of it is
/// the rotated shape.
[[nodiscard]] Vec3 turned(const Vec3 &p, const Vec3 &centre, std::size_t axis, double degrees);
/// Union whose seam is rounded over about `width` mm.
[[nodiscard]] double blend(double a, double b, double width);
/// The body without the tool, with a rounded edge.
[[nodiscard]] double carve(double body, double tool, double width);
/// A liver as one draws it: a large right lobe (patient's right is -x), a small left lobe that thins out, a hollow
/// underside with the hilum, and a notch between the lobes in front. LPS mm, centred near the origin.
[[nodiscard]] double liver(const Vec3 &p);

}  // namespace c3de::tools
