// SPDX-License-Identifier: Apache-2.0
#include "solid_shapes.h"

#include <algorithm>
#include <cmath>

namespace solids {

using pointbased::Index;
using pointbased::Surface;

namespace {

using Distance = std::function<double(const Vec3 &)>;  // m, negative inside
constexpr double kPi = EIGEN_PI;

BodyShape fromDistance(const Vec3 &min, const Vec3 &max, double volume, Distance distance, Surface surface) {
  BodyShape shape;
  shape.min = min;
  shape.max = max;
  shape.volume = volume;
  shape.surface = std::move(surface);
  shape.inside = [distance](std::span<const Vec3> points, std::span<double> inside) {
    for (std::size_t i = 0; i < points.size(); ++i) inside[i] = distance(points[i]) < 0.0 ? 1.0 : 0.0;
  };
  shape.surfaceDistance = [distance](std::span<const Vec3> points, std::span<double> distances) {
    for (std::size_t i = 0; i < points.size(); ++i) distances[i] = std::abs(distance(points[i]));
  };
  return shape;
}

/// at(s, t) over the unit square in n x m parts; outwards is d/ds x d/dt.
template <class At>
void addPatch(Surface &surface, int n, int m, const At &at) {
  const auto first = static_cast<Index>(surface.positions.size());
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i)
      surface.positions.push_back(at(static_cast<double>(i) / n, static_cast<double>(j) / m));
  const auto index = [&](int i, int j) { return first + static_cast<Index>(j * (n + 1) + i); };
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      surface.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      surface.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
}

double boxDistance(const Vec3 &x, const Vec3 &min, const Vec3 &max) {
  const Vec3 outside = (min - x).cwiseMax(x - max);
  const double most = outside.maxCoeff();
  return most > 0.0 ? outside.cwiseMax(0.0).norm() : most;
}

Vec3 onSphere(double azimuth, double polar) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Distance to an ellipsoid: Σ (r x / (t + r²))² = 1 has one root above -min r², found by bisection.
double ellipsoidDistance(const Vec3 &x, const Vec3 &r) {
  // Off the planes of symmetry, where the root would approach its pole.
  const Vec3 p = x.cwiseAbs().cwiseMax(1e-9 * r);
  const Vec3 squares = r.cwiseProduct(r);
  const auto excess = [&](double t) {
    return (r.cwiseProduct(p).array() / (squares.array() + t)).matrix().squaredNorm() - 1.0;
  };
  double low = -squares.minCoeff(), high = r.maxCoeff() * p.norm();
  for (int i = 0; i < 80; ++i) {
    const double t = 0.5 * (low + high);
    (excess(t) > 0.0 ? low : high) = t;
  }
  const Vec3 nearest = squares.cwiseProduct(p).cwiseQuotient((squares.array() + high).matrix());
  const double sign = p.cwiseQuotient(r).squaredNorm() < 1.0 ? -1.0 : 1.0;
  return sign * (p - nearest).norm();
}

}  // namespace

BodyShape box(const Vec3 &min, const Vec3 &max) {
  Surface surface;
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (const bool high : {false, true})
      addPatch(surface, 1, 1, [&](double s, double t) {
        Vec3 x;
        x[axis] = high ? max[axis] : min[axis];
        x[high ? b : c] = s > 0.5 ? max[high ? b : c] : min[high ? b : c];
        x[high ? c : b] = t > 0.5 ? max[high ? c : b] : min[high ? c : b];
        return x;
      });
  }
  return fromDistance(
      min, max, (max - min).prod(), [=](const Vec3 &x) { return boxDistance(x, min, max); }, surface);
}

BodyShape ball(const Vec3 &centre, double radius) {
  Surface surface;
  addPatch(surface, 48, 96,
           [&](double s, double t) -> Vec3 { return centre + radius * onSphere(2 * kPi * t, kPi * s); });
  return fromDistance(
      centre.array() - radius, centre.array() + radius, 4.0 / 3.0 * kPi * std::pow(radius, 3),
      [=](const Vec3 &x) { return (x - centre).norm() - radius; }, surface);
}

BodyShape halfBall(double radius) {
  Surface surface;
  addPatch(surface, 24, 96, [&](double s, double t) -> Vec3 { return radius * onSphere(2 * kPi * t, 0.5 * kPi * s); });
  addPatch(surface, 96, 24, [&](double s, double t) {
    return Vec3(radius * t * std::cos(2 * kPi * s), radius * t * std::sin(2 * kPi * s), 0.0);
  });
  return fromDistance(
      Vec3(-radius, -radius, 0.0), Vec3(radius, radius, radius), 2.0 / 3.0 * kPi * std::pow(radius, 3),
      [=](const Vec3 &x) { return std::max(x.norm() - radius, -x[2]); }, surface);
}

BodyShape ellipsoid(const Vec3 &semiAxes) {
  Surface surface;
  addPatch(surface, 48, 96,
           [&](double s, double t) -> Vec3 { return semiAxes.cwiseProduct(onSphere(2 * kPi * t, kPi * s)); });
  return fromDistance(
      -semiAxes, semiAxes, 4.0 / 3.0 * kPi * semiAxes.prod(),
      [=](const Vec3 &x) { return ellipsoidDistance(x, semiAxes); }, surface);
}

BodyShape ringQuarter(double radius, double width) {
  const double inner = radius - 0.5 * width, outer = radius + 0.5 * width, half = 0.5 * width;
  const auto at = [](double rho, double angle, double z) {
    return Vec3(rho * std::cos(angle), rho * std::sin(angle), z);
  };
  const auto angle = [](double s) { return 0.5 * kPi * s; };
  Surface surface;
  addPatch(surface, 48, 1, [&](double s, double t) { return at(outer, angle(s), -half + width * t); });
  addPatch(surface, 1, 48, [&](double s, double t) { return at(inner, angle(t), -half + width * s); });
  addPatch(surface, 8, 48, [&](double s, double t) { return at(inner + width * s, angle(t), half); });
  addPatch(surface, 48, 8, [&](double s, double t) { return at(inner + width * t, angle(s), -half); });
  addPatch(surface, 1, 1, [&](double s, double t) { return Vec3(inner + width * s, 0.0, -half + width * t); });
  addPatch(surface, 1, 1, [&](double s, double t) { return Vec3(0.0, inner + width * t, -half + width * s); });
  const auto distance = [=](const Vec3 &x) {
    const double rho = std::hypot(x[0], x[1]);
    return std::max({std::abs(rho - radius) - half, std::abs(x[2]) - half, -x[0], -x[1]});
  };
  return fromDistance(Vec3(0, 0, -half), Vec3(outer, outer, half), 0.5 * kPi * radius * width * width, distance,
                      surface);
}

BodyShape tube(double inner, double outer, double length) {
  Surface surface;
  const auto at = [=](double x, double rho, double s) {
    return Vec3(x, rho * std::cos(2 * kPi * s), rho * std::sin(2 * kPi * s));
  };
  addPatch(surface, 96, 48, [&](double s, double t) { return at(length * t, outer, s); });
  addPatch(surface, 96, 48, [&](double s, double t) { return at(length * t, inner, -s); });
  addPatch(surface, 8, 96, [&](double s, double t) { return at(length, inner + (outer - inner) * s, t); });
  addPatch(surface, 96, 8, [&](double s, double t) { return at(0.0, inner + (outer - inner) * t, s); });
  const auto distance = [=](const Vec3 &x) {
    const double rho = std::hypot(x[1], x[2]);
    return std::max({rho - outer, inner - rho, -x[0], x[0] - length});
  };
  return fromDistance(Vec3(0.0, -outer, -outer), Vec3(length, outer, outer),
                      kPi * (outer * outer - inner * inner) * length, distance, surface);
}

BodyShape slantedBox(const Vec3 &min, const Vec3 &max, double slant) {
  const BodyShape straight = box(min, max);
  Surface surface = straight.surface;
  for (Vec3 &x : surface.positions) x[1] += slant * x[2];
  const double reach = std::abs(slant) * std::max(std::abs(min[2]), std::abs(max[2]));
  const double width = std::hypot(1.0, slant);
  const auto distance = [=](const Vec3 &x) {
    const double y = x[1] - slant * x[2];
    return std::max(
        {min[0] - x[0], x[0] - max[0], min[2] - x[2], x[2] - max[2], (min[1] - y) / width, (y - max[1]) / width});
  };
  return fromDistance(min - Vec3(0.0, reach, 0.0), max + Vec3(0.0, reach, 0.0), straight.volume, distance, surface);
}

BodyShape cylinder(double radius, double length) {
  Surface surface;
  const auto at = [&](double rho, double s, double z) {
    return Vec3(rho * std::cos(2 * kPi * s), rho * std::sin(2 * kPi * s), z);
  };
  addPatch(surface, 96, 24, [&](double s, double t) { return at(radius, s, length * t); });
  addPatch(surface, 12, 96, [&](double s, double t) { return at(radius * s, t, length); });
  addPatch(surface, 96, 12, [&](double s, double t) { return at(radius * t, s, 0.0); });
  const auto distance = [=](const Vec3 &x) {
    return std::max({std::hypot(x[0], x[1]) - radius, -x[2], x[2] - length});
  };
  return fromDistance(Vec3(-radius, -radius, 0.0), Vec3(radius, radius, length), kPi * radius * radius * length,
                      distance, surface);
}

}  // namespace solids
