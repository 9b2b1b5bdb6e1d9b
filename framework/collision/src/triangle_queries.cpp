// SPDX-License-Identifier: Apache-2.0
#include "triangle_queries.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace c3de::collision {

WatertightRay::WatertightRay(const Vec3 &origin, const Vec3 &direction) : origin_(origin) {
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(direction[k]) > std::abs(direction[kz_])) kz_ = k;
  kx_ = (kz_ + 1) % 3;
  ky_ = (kx_ + 1) % 3;
  shearX_ = direction[kx_] / direction[kz_];
  shearY_ = direction[ky_] / direction[kz_];
  scaleZ_ = 1.0 / direction[kz_];
}

bool WatertightRay::intersect(const Vec3 &va, const Vec3 &vb, const Vec3 &vc, Hit &hit) const {
  const Vec3 a = va - origin_, b = vb - origin_, c = vc - origin_;
  // The ray becomes the z axis; the remaining test is whether the origin is in a 2-D triangle.
  const double ax = a[kx_] - shearX_ * a[kz_], ay = a[ky_] - shearY_ * a[kz_];
  const double bx = b[kx_] - shearX_ * b[kz_], by = b[ky_] - shearY_ * b[kz_];
  const double cx = c[kx_] - shearX_ * c[kz_], cy = c[ky_] - shearY_ * c[kz_];
  const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
  const double determinant = u + v + w;
  if (determinant == 0.0) return false;
  hit.bary = {u / determinant, v / determinant, w / determinant};
  hit.t = scaleZ_ * (hit.bary[0] * a[kz_] + hit.bary[1] * b[kz_] + hit.bary[2] * c[kz_]);
  return true;
}

namespace {

TrianglePoint finish(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &bary, Feature feature) {
  TrianglePoint result;
  result.bary = bary;
  result.feature = feature;
  switch (feature) {
    // A corner is returned exactly, so that its triangles agree on the distance.
    case Feature::cornerA: result.point = a; break;
    case Feature::cornerB: result.point = b; break;
    case Feature::cornerC: result.point = c; break;
    default: result.point = a + bary[1] * (b - a) + bary[2] * (c - a);
  }
  const Vec3 d = p - result.point;
  result.distanceSquared = dot(d, d);
  return result;
}

/// Fraction of the distance from a to b, in [0, 1].
double closestOnSegment(const Vec3 &p, const Vec3 &a, const Vec3 &b) {
  const Vec3 ab = b - a;
  const double length2 = dot(ab, ab);
  return length2 > 0.0 ? std::clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
}

TrianglePoint closestOnSides(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const auto onSide = [&](const Vec3 &from, const Vec3 &to, std::size_t i, std::size_t j, Feature side, Feature first,
                          Feature second) {
    const double s = closestOnSegment(p, from, to);
    Vec3 bary{};
    bary[i] = 1.0 - s;
    bary[j] = s;
    return finish(p, a, b, c, bary, s == 0.0 ? first : s == 1.0 ? second : side);
  };
  TrianglePoint best = onSide(a, b, 0, 1, Feature::edgeAB, Feature::cornerA, Feature::cornerB);
  for (const TrianglePoint &other : {onSide(b, c, 1, 2, Feature::edgeBC, Feature::cornerB, Feature::cornerC),
                                     onSide(c, a, 2, 0, Feature::edgeCA, Feature::cornerC, Feature::cornerA)})
    if (other.distanceSquared < best.distanceSquared) best = other;
  return best;
}

}  // namespace

TrianglePoint closestOnTriangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  constexpr double kFlat = 1e-13;  // sine of the angle below which the normal is only rounding error
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const Vec3 n = cross(ab, ac);
  const double longest2 = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
  if (!(dot(n, n) > kFlat * kFlat * longest2 * longest2)) return closestOnSides(p, a, b, c);

  // Region of the plane, after Ericson, Real-Time Collision Detection (2005), 5.1.5.
  const Vec3 ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return finish(p, a, b, c, {1.0, 0.0, 0.0}, Feature::cornerA);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return finish(p, a, b, c, {0.0, 1.0, 0.0}, Feature::cornerB);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double s = d1 / (d1 - d3);
    return finish(p, a, b, c, {1.0 - s, s, 0.0}, Feature::edgeAB);
  }
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return finish(p, a, b, c, {0.0, 0.0, 1.0}, Feature::cornerC);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double s = d2 / (d2 - d6);
    return finish(p, a, b, c, {1.0 - s, 0.0, s}, Feature::edgeCA);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return finish(p, a, b, c, {0.0, 1.0 - s, s}, Feature::edgeBC);
  }
  const double inverse = 1.0 / (va + vb + vc);
  return finish(p, a, b, c, {1.0 - vb * inverse - vc * inverse, vb * inverse, vc * inverse}, Feature::face);
}

}  // namespace c3de::collision
