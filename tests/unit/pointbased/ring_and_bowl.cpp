// SPDX-License-Identifier: Apache-2.0
#include "ring_and_bowl.h"

#include <cmath>

namespace shapes {

using namespace pointbased;

namespace {

using Closest = std::function<SurfacePoint(const Vec3 &)>;

// A step is much shorter than the thickness of the sampled shapes, so a change of sign is not missed.
constexpr int kSamples = 16;

Obstacle obstacleBy(const char *name, double friction, const Closest &closest) {
  Obstacle o;
  o.name = name;
  o.friction = friction;
  o.closest = [closest](std::span<const Vec3> points, std::span<const double> ranges, std::span<SurfacePoint> out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i] = closest(points[i]);
      if (std::abs(out[i].distance) > ranges[i]) out[i].distance = std::numeric_limits<double>::infinity();
    }
  };
  o.crossing = [closest](const Vec3 &from, const Vec3 &to, Vec3 &normal) {
    const auto isInside = [&](double t) { return closest(from + t * (to - from)).distance < 0.0; };
    const bool atStart = isInside(0.0);
    for (int k = 1; k <= kSamples; ++k) {
      double low = static_cast<double>(k - 1) / kSamples, high = static_cast<double>(k) / kSamples;
      if (isInside(high) == atStart) continue;
      for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (isInside(middle) == atStart ? low : high) = middle;
      }
      normal = closest(from + low * (to - from)).normal;
      return low;
    }
    return -1.0;
  };
  return o;
}

SurfacePoint closestOnTorus(const Vec3 &x, const Vec3 &centre, double radius, double tube) {
  const Vec3 from = x - centre;
  const double out = std::hypot(from[0], from[2]);
  const Vec3 outward = out > 0.0 ? Vec3(from[0] / out, 0.0, from[2] / out) : Vec3(Vec3::UnitX());
  const Vec3 way = from - radius * outward;
  const double size = way.norm();
  return {size > 0.0 ? Vec3(way / size) : Vec3(Vec3::UnitY()), size - tube};
}

SurfacePoint closestOnBowl(const Vec3 &x, double radius) {
  const double size = x.norm(), out = std::hypot(x[0], x[2]);
  const Vec3 inward = size > 0.0 ? Vec3(-x / size) : Vec3(Vec3::UnitY());
  if (x[1] <= 0.0) {
    const double ofSphere = radius - size;
    if (ofSphere >= 0.0 || ofSphere > x[1]) return {inward, ofSphere};
    return {Vec3::UnitY(), x[1]};
  }
  if (out >= radius) return {Vec3::UnitY(), x[1]};
  const Vec3 rim = out > 0.0 ? Vec3(radius / out * Vec3(x[0], 0.0, x[2])) : Vec3(radius * Vec3::UnitX());
  return {(x - rim).normalized(), (x - rim).norm()};
}

}  // namespace

Obstacle torus(const Vec3 &centre, double radius, double tube, double friction) {
  return obstacleBy("ring", friction, [=](const Vec3 &x) { return closestOnTorus(x, centre, radius, tube); });
}

double distanceToTorus(const Vec3 &x, const Vec3 &centre, double radius, double tube) {
  return closestOnTorus(x, centre, radius, tube).distance;
}

Obstacle bowl(double radius, double friction) {
  return obstacleBy("bowl", friction, [=](const Vec3 &x) { return closestOnBowl(x, radius); });
}

}  // namespace shapes
