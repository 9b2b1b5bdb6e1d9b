// SPDX-License-Identifier: Apache-2.0
// Arithmetic of three numbers.
#pragma once

#include <algorithm>
#include <cmath>

#include "c3de/sdk/sdk.hpp"

namespace mass_spring {

namespace sdk = c3de::sdk;
using Vec3 = sdk::Vec3;

constexpr Vec3 operator+(const Vec3 &a, const Vec3 &b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
constexpr Vec3 operator-(const Vec3 &a, const Vec3 &b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
constexpr Vec3 operator*(double s, const Vec3 &a) { return {s * a[0], s * a[1], s * a[2]}; }
constexpr Vec3 &operator+=(Vec3 &a, const Vec3 &b) { return a = a + b; }
constexpr Vec3 &operator-=(Vec3 &a, const Vec3 &b) { return a = a - b; }
constexpr double dot(const Vec3 &a, const Vec3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
constexpr Vec3 cross(const Vec3 &a, const Vec3 &b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3 &a) { return std::sqrt(dot(a, a)); }
inline bool isFinite(const Vec3 &a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }
constexpr Vec3 vectorOf(const double *p) { return {p[0], p[1], p[2]}; }

/// A rotation, by rows.
using Mat3 = std::array<Vec3, 3>;
constexpr Vec3 operator*(const Mat3 &m, const Vec3 &v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

/// About x, then y, then z.
inline Mat3 rotationOf(const Vec3 &angles_rad) {
  const double a = std::cos(angles_rad[0]), b = std::sin(angles_rad[0]), c = std::cos(angles_rad[1]),
               d = std::sin(angles_rad[1]), e = std::cos(angles_rad[2]), f = std::sin(angles_rad[2]);
  return {{{c * e, b * d * e - a * f, a * d * e + b * f},
           {c * f, b * d * f + a * e, a * d * f - b * e},
           {-d, b * c, a * c}}};
}

}  // namespace mass_spring
