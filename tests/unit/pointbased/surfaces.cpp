// SPDX-License-Identifier: Apache-2.0
#include "surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace shapes {

using namespace pointbased;

Surface boxSurface(const Vec3 &min, const Vec3 &max, int n) {
  Surface s;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const auto first = static_cast<Index>(s.positions.size());
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          Vec3 t;
          t[axis] = side;
          t[a] = static_cast<double>(i) / n;
          t[b] = static_cast<double>(j) / n;
          s.positions.push_back(min + t.cwiseProduct(max - min));
        }
      const auto at = [&](int i, int j) { return first + static_cast<Index>(i * (n + 1) + j); };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::array<Index, 3> t1{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
              t2{at(i, j), at(i + 1, j + 1), at(i, j + 1)};
          if (side == 0) {
            std::swap(t1[1], t1[2]);
            std::swap(t2[1], t2[2]);
          }
          s.triangles.push_back(t1);
          s.triangles.push_back(t2);
        }
    }
  return s;
}

Surface ballSurface(const Vec3 &centre, double radius, int n) {
  Surface s;
  const int around = 2 * n;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = std::numbers::pi * i / n, phi = 2.0 * std::numbers::pi * j / around;
      const double ring = i == 0 || i == n ? 0.0 : std::sin(theta);
      s.positions.push_back(centre + radius * Vec3(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta)));
    }
  const auto at = [&](int i, int j) { return static_cast<Index>(i * around + j % around); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) s.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < n) s.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
    }
  return s;
}

namespace {

double solidAngle(const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

double distanceTo(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const Vec3 n = (b - a).cross(c - a);
  const std::array<Vec3, 3> corner{a, b, c};
  bool over = n.squaredNorm() > 0.0;
  double best = 1e300;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &from = corner[i], edge = corner[(i + 1) % 3] - from;
    over = over && edge.cross(p - from).dot(n) >= 0.0;
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp((p - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    best = std::min(best, (from + t * edge - p).norm());
  }
  return over ? std::min(best, std::abs((p - a).dot(n)) / n.norm()) : best;
}

}  // namespace

double volumeOf(const Surface &s) {
  double volume = 0.0;
  for (const auto &[a, b, c] : s.triangles) volume += s.positions[a].dot(s.positions[b].cross(s.positions[c])) / 6.0;
  return volume;
}

BodyShape inside(const Surface &surface) {
  BodyShape shape;
  shape.min = Vec3::Constant(1e300);
  shape.max = Vec3::Constant(-1e300);
  for (const Vec3 &x : surface.positions) {
    shape.min = shape.min.cwiseMin(x);
    shape.max = shape.max.cwiseMax(x);
  }
  shape.volume = volumeOf(surface);
  shape.surface = surface;
  shape.inside = [surface](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      double sum = 0.0;
      for (const auto &[a, b, c] : surface.triangles)
        sum += solidAngle(surface.positions[a] - points[i], surface.positions[b] - points[i],
                          surface.positions[c] - points[i]);
      out[i] = sum / (4.0 * std::numbers::pi);
    }
  };
  shape.surfaceDistance = [surface](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i] = 1e300;
      for (const auto &[a, b, c] : surface.triangles)
        out[i] =
            std::min(out[i], distanceTo(points[i], surface.positions[a], surface.positions[b], surface.positions[c]));
    }
  };
  return shape;
}

double areaOf(const Surface &s) {
  double area = 0.0;
  for (const auto &[a, b, c] : s.triangles)
    area += 0.5 * (s.positions[b] - s.positions[a]).cross(s.positions[c] - s.positions[a]).norm();
  return area;
}

double sum(const std::vector<double> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace shapes
