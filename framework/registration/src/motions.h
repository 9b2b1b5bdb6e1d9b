// SPDX-License-Identifier: Apache-2.0
// Private to registration: rotations, and how far two motions are apart.
#pragma once

#include <span>
#include <vector>

#include "c3de/core/vec.h"

namespace c3de::registration {

[[nodiscard]] Vec3 turned(const Mat4 &m, const Vec3 &direction);
/// The motion with this rotation that moves `from` to `to`.
[[nodiscard]] Mat4 withPoint(const Mat4 &rotation, const Vec3 &from, const Vec3 &to);
/// Rotation about the origin by the length of the vector, radians.
[[nodiscard]] Mat4 rotationOf(const Vec3 &vector);
/// The rotation of smallest angle from one unit vector to another.
[[nodiscard]] Mat4 rotationBetween(const Vec3 &from, const Vec3 &to);
/// `count` rotations that are uniform in the group of rotations: super-Fibonacci spirals (Alexa, CVPR 2022).
[[nodiscard]] std::vector<Mat4> uniformRotations(std::size_t count);
/// Root mean square of the distance between the images of the points under two motions.
[[nodiscard]] double distanceOf(const Mat4 &a, const Mat4 &b, std::span<const Vec3> points);
/// Up to `count` of the points, in an order that is arbitrary but always the same.
[[nodiscard]] std::vector<std::size_t> shuffledIndices(std::size_t points, std::size_t count);
/// Indices of `count` points, each the farthest from those before; the first is the point 0.
[[nodiscard]] std::vector<std::size_t> spreadIndices(std::span<const Vec3> points, std::size_t count);

}  // namespace c3de::registration
