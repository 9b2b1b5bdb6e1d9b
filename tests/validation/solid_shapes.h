// SPDX-License-Identifier: Apache-2.0
// Exact bodies: a signed distance as a formula, the border as a triangulation of its patches.
#pragma once

#include "pointbased/sampling.h"

namespace solids {

using pointbased::BodyShape;
using pointbased::Vec3;

/// Edges along the axes, m.
[[nodiscard]] BodyShape box(const Vec3 &min, const Vec3 &max);
[[nodiscard]] BodyShape ball(const Vec3 &centre, double radius);
/// z >= 0 of a ball about the origin.
[[nodiscard]] BodyShape halfBall(double radius);
/// About the origin, axes along x, y, z.
[[nodiscard]] BodyShape ellipsoid(const Vec3 &semiAxes);
/// A quarter of a ring about z from the x axis to the y axis: a square section of `width` about a circle of `radius`.
[[nodiscard]] BodyShape ringQuarter(double radius, double width);
/// x from 0 to length, about the x axis.
[[nodiscard]] BodyShape tube(double inner, double outer, double length);
/// A box whose points are displaced along y by slant z.
[[nodiscard]] BodyShape slantedBox(const Vec3 &min, const Vec3 &max, double slant);
/// z from 0 to length, about the z axis.
[[nodiscard]] BodyShape cylinder(double radius, double length);

}  // namespace solids
