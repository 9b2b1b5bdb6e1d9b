// SPDX-License-Identifier: Apache-2.0
#include "matching/skin_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointbased::detail {

Vec3 closestOfTriangle(const Vec3 &x, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
  const Vec3 ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return {1.0, 0.0, 0.0};
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return {0.0, 1.0, 0.0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return {1.0 - v, v, 0.0};
  }
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return {0.0, 0.0, 1.0};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return {1.0 - w, 0.0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0.0, 1.0 - w, w};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return {1.0, 0.0, 0.0};
  return {va / sum, vb / sum, vc / sum};
}

void SkinDistance::move(std::span<const Vec3> positions) {
  positions_ = positions;
  const std::size_t n = triangles_.size();
  centres_.resize(n);
  normals_.resize(n);
  radii_.resize(n);
  for (std::size_t t = 0; t < n; ++t) {
    const Vec3 &a = positions[triangles_[t][0]], &b = positions[triangles_[t][1]], &c = positions[triangles_[t][2]];
    centres_[t] = (a + b + c) / 3.0;
    radii_[t] = std::sqrt(
        std::max({(a - centres_[t]).squaredNorm(), (b - centres_[t]).squaredNorm(), (c - centres_[t]).squaredNorm()}));
    normals_[t] = (b - a).cross(c - a).normalized();
  }
}

ClosestSkinPoint SkinDistance::closest(const Vec3 &x, const Vec3 &normal, double cosine, Index guess) const {
  ClosestSkinPoint out;
  double best = std::numeric_limits<double>::infinity();
  const bool isOriented = !normal.isZero(0.0);
  const auto visit = [&](std::size_t t) {
    const auto &corners = triangles_[t];
    const Vec3 &a = positions_[corners[0]], &b = positions_[corners[1]], &c = positions_[corners[2]];
    const Vec3 weights = closestOfTriangle(x, a, b, c);
    const Vec3 at = weights[0] * a + weights[1] * b + weights[2] * c;
    const double distance = (x - at).norm();
    if (!(distance < best)) return;
    best = distance;
    out = {static_cast<Index>(t), weights, at, normals_[t]};
  };
  const auto faces = [&](std::size_t t) { return !isOriented || normals_[t].dot(normal) >= cosine; };
  // The result must not depend on the guess, so it only bounds the distance.
  if (guess < triangles_.size() && faces(guess)) {
    visit(guess);
    best = std::nextafter(best, std::numeric_limits<double>::infinity());
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const double reach = best + radii_[t];
    if ((x - centres_[t]).squaredNorm() >= reach * reach || !faces(t)) continue;
    visit(t);
  }
  return out;
}

}  // namespace pointbased::detail
