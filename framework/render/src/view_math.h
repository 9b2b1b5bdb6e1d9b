// SPDX-License-Identifier: Apache-2.0
// Small matrix functions for conversion between the double transforms of the host and the floats of the graphics card.
#pragma once

#include <array>
#include <cmath>

#include "c3de/core/vec.h"
#include "c3de/render/renderer.h"

namespace c3de::render {

using Mat3f = std::array<float, 9>;   ///< column-major
using Mat4f = std::array<float, 16>;  ///< column-major

inline Mat4f toFloat(const Mat4 &m) {
  Mat4f r{};
  for (std::size_t i = 0; i < 16; ++i) r[i] = static_cast<float>(m[i]);
  return r;
}

inline double linearDeterminant(const Mat4 &m) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]);
}

/// Maps outward normals to outward normals, also under mirroring; the result is not of unit length.
inline Mat3f normalMatrix(const Mat4 &m) {
  // The inverse transpose is the cofactor matrix up to the determinant, of which only the sign matters here.
  const double s = linearDeterminant(m) < 0.0 ? -1.0 : 1.0;
  const auto f = [s](double v) { return static_cast<float>(s * v); };
  return {f(m[5] * m[10] - m[6] * m[9]), f(m[6] * m[8] - m[4] * m[10]), f(m[4] * m[9] - m[5] * m[8]),
          f(m[2] * m[9] - m[1] * m[10]), f(m[0] * m[10] - m[2] * m[8]), f(m[1] * m[8] - m[0] * m[9]),
          f(m[1] * m[6] - m[2] * m[5]),  f(m[2] * m[4] - m[0] * m[6]),  f(m[0] * m[5] - m[1] * m[4])};
}

/// Mean scale factor of lengths over the directions (exact for rotations with uniform scale).
inline float lengthScale(const Mat4 &m) { return static_cast<float>(std::cbrt(std::abs(linearDeterminant(m)))); }

inline Vec3f transformPoint(const Mat4f &m, const Vec3f &p) {
  return {m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12], m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13],
          m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14]};
}

inline Vec3f transformNormal(const Mat3f &m, const Vec3f &n) {
  return {m[0] * n[0] + m[3] * n[1] + m[6] * n[2], m[1] * n[0] + m[4] * n[1] + m[7] * n[2],
          m[2] * n[0] + m[5] * n[1] + m[8] * n[2]};
}

using Rgba8 = std::array<std::uint8_t, 4>;
inline Rgba8 toRgba8(const Colour &c, float opacity = 1.0f) {
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(v > 0.0f ? (v < 1.0f ? v * 255.0f + 0.5f : 255.0f) : 0.0f);  // NaN: 0
  };
  return {byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3] * opacity)};
}

}  // namespace c3de::render
