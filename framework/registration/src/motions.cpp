// SPDX-License-Identifier: Apache-2.0
#include "motions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace c3de::registration {
namespace {

Mat4 ofQuaternion(double x, double y, double z, double w) {
  Mat4 m = kIdentity4;
  m[0] = 1.0 - 2.0 * (y * y + z * z), m[4] = 2.0 * (x * y - z * w), m[8] = 2.0 * (x * z + y * w);
  m[1] = 2.0 * (x * y + z * w), m[5] = 1.0 - 2.0 * (x * x + z * z), m[9] = 2.0 * (y * z - x * w);
  m[2] = 2.0 * (x * z - y * w), m[6] = 2.0 * (y * z + x * w), m[10] = 1.0 - 2.0 * (x * x + y * y);
  return m;
}

}  // namespace

Vec3 turned(const Mat4 &m, const Vec3 &d) {
  return {m[0] * d[0] + m[4] * d[1] + m[8] * d[2], m[1] * d[0] + m[5] * d[1] + m[9] * d[2],
          m[2] * d[0] + m[6] * d[1] + m[10] * d[2]};
}

Mat4 withPoint(const Mat4 &rotation, const Vec3 &from, const Vec3 &to) {
  Mat4 m = rotation;
  const Vec3 t = to - turned(rotation, from);
  m[12] = t[0], m[13] = t[1], m[14] = t[2];
  return m;
}

Mat4 rotationOf(const Vec3 &vector) {
  const double angle = norm(vector);
  if (!(angle > 0.0)) return kIdentity4;
  const double s = std::sin(0.5 * angle) / angle;
  return ofQuaternion(s * vector[0], s * vector[1], s * vector[2], std::cos(0.5 * angle));
}

Mat4 rotationBetween(const Vec3 &from, const Vec3 &to) {
  const Vec3 axis = cross(from, to);
  const double w = 1.0 + dot(from, to);
  if (w < 1e-9) {
    // Opposite directions: half a turn about any axis across.
    const Vec3 other = std::abs(from[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 across = cross(from, other);
    return rotationOf((std::numbers::pi / norm(across)) * across);
  }
  const double length = std::sqrt(dot(axis, axis) + w * w);
  return ofQuaternion(axis[0] / length, axis[1] / length, axis[2] / length, w / length);
}

std::vector<Mat4> uniformRotations(std::size_t count) {
  constexpr double kPhi = std::numbers::sqrt2, kPsi = 1.533751168755204288118041;
  std::vector<Mat4> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double s = static_cast<double>(i) + 0.5, t = s / static_cast<double>(count), d = 2.0 * std::numbers::pi * s;
    const double r = std::sqrt(t), rest = std::sqrt(1.0 - t), alpha = d / kPhi, beta = d / kPsi;
    out.push_back(ofQuaternion(r * std::sin(alpha), r * std::cos(alpha), rest * std::sin(beta), rest * std::cos(beta)));
  }
  return out;
}

double distanceOf(const Mat4 &a, const Mat4 &b, std::span<const Vec3> points) {
  double squares = 0.0;
  for (const Vec3 &p : points) {
    const Vec3 d = transformPoint(a, p) - transformPoint(b, p);
    squares += dot(d, d);
  }
  return points.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(points.size()));
}

std::vector<std::size_t> shuffledIndices(std::size_t points, std::size_t count) {
  std::vector<std::size_t> all(points);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  count = std::min(count, points);
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    std::swap(all[i], all[i + (state >> 33) % (points - i)]);
  }
  all.resize(count);
  return all;
}

std::vector<std::size_t> spreadIndices(std::span<const Vec3> points, std::size_t count) {
  std::vector<std::size_t> out;
  std::vector<double> away(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t next = 0; out.size() < std::min(count, points.size());) {
    out.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = points[i] - points[out.back()];
      away[i] = std::min(away[i], dot(d, d));
    }
    next = static_cast<std::size_t>(std::max_element(away.begin(), away.end()) - away.begin());
  }
  return out;
}

}  // namespace c3de::registration
