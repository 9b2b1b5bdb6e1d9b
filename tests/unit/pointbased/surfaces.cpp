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

// Closed surfaces, queried by rays along x, which meet few of the triangles.
class InsideOf {
 public:
  explicit InsideOf(const Surface &surface) : surface_(surface) {
    low_ = Vec3::Constant(1e300);
    high_ = -low_;
    for (const Vec3 &x : surface.positions) {
      low_ = low_.cwiseMin(x);
      high_ = high_.cwiseMax(x);
    }
    columns_.resize(kColumns * kColumns);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      const auto &[a, b, c] = surface.triangles[t];
      const Vec3 &pa = surface.positions[a], &pb = surface.positions[b], &pc = surface.positions[c];
      const Vec3 least = pa.cwiseMin(pb).cwiseMin(pc), most = pa.cwiseMax(pb).cwiseMax(pc);
      for (std::size_t j = columnOf(least, 1); j <= columnOf(most, 1); ++j)
        for (std::size_t k = columnOf(least, 2); k <= columnOf(most, 2); ++k)
          columns_[j * kColumns + k].push_back(static_cast<Index>(t));
    }
  }

  // Winding number of the surface around a point.
  [[nodiscard]] double operator()(const Vec3 &point) const {
    if ((point.array() < low_.array()).any() || (point.array() > high_.array()).any()) return 0.0;
    // Offset from edges and corners that are on planes of a lattice.
    const Vec3 p = point + 1e-8 * (high_ - low_).cwiseProduct(Vec3(0.0, 0.7310585, 0.4142135));
    double winds = 0.0;
    for (const Index t : columns_[columnOf(p, 1) * kColumns + columnOf(p, 2)]) {
      const auto &[ia, ib, ic] = surface_.triangles[t];
      const Vec3 a = surface_.positions[ia] - p, b = surface_.positions[ib] - p, c = surface_.positions[ic] - p;
      const double wa = b[1] * c[2] - b[2] * c[1], wb = c[1] * a[2] - c[2] * a[1], wc = a[1] * b[2] - a[2] * b[1];
      const double sum = wa + wb + wc;
      if (!((wa > 0.0 && wb > 0.0 && wc > 0.0) || (wa < 0.0 && wb < 0.0 && wc < 0.0))) continue;
      if ((wa * a[0] + wb * b[0] + wc * c[0]) / sum > 0.0) winds += sum > 0.0 ? 1.0 : -1.0;
    }
    return winds;
  }

 private:
  static constexpr std::size_t kColumns = 32;
  [[nodiscard]] std::size_t columnOf(const Vec3 &x, int axis) const {
    const double part = (x[axis] - low_[axis]) / std::max(1e-300, high_[axis] - low_[axis]);
    return static_cast<std::size_t>(std::clamp(part * kColumns, 0.0, kColumns - 1.0));
  }

  Surface surface_;
  Vec3 low_, high_;
  std::vector<std::vector<Index>> columns_;
};

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

BodyShape box(const Vec3 &min, const Vec3 &max, int n) {
  BodyShape shape = box(min, max);
  shape.surface = boxSurface(min, max, n);
  return shape;
}

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
  shape.inside = [winds = InsideOf(surface)](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = winds(points[i]);
  };
  std::vector<std::pair<Vec3, double>> spheres;  // around the triangles
  for (const auto &[a, b, c] : surface.triangles) {
    const Vec3 &pa = surface.positions[a], &pb = surface.positions[b], &pc = surface.positions[c];
    const Vec3 middle = (pa + pb + pc) / 3.0;
    spheres.emplace_back(middle, std::max({(pa - middle).norm(), (pb - middle).norm(), (pc - middle).norm()}));
  }
  shape.surfaceDistance = [surface, spheres](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i] = 1e300;
      for (std::size_t t = 0; t < spheres.size(); ++t) {
        const double reach = out[i] + spheres[t].second;
        if ((points[i] - spheres[t].first).squaredNorm() >= reach * reach) continue;
        const auto &[a, b, c] = surface.triangles[t];
        out[i] =
            std::min(out[i], distanceTo(points[i], surface.positions[a], surface.positions[b], surface.positions[c]));
      }
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

Surface joined(Surface a, const Surface &b) {
  const auto shift = static_cast<Index>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto &t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

double sum(const std::vector<double> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

}  // namespace shapes
