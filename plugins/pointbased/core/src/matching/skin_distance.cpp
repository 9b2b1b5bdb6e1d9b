// SPDX-License-Identifier: Apache-2.0
#include "matching/skin_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pointbased::detail {
namespace {

constexpr std::size_t kGroup = 64;  // triangles

}  // namespace

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

// Halves the triangles by their centres along the longest side of the box of these, down to groups.
void SkinDistance::group() {
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), Index{0});
  const std::size_t count = (order_.size() + kGroup - 1) / kGroup;
  groups_.resize(count);
  const auto halve = [&](const auto &self, std::size_t first, std::size_t last) -> void {
    if (last - first < 2) return;
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first * kGroup),
               end = order_.begin() + static_cast<std::ptrdiff_t>(std::min(last * kGroup, order_.size()));
    Vec3 low = balls_[*begin].centre, high = low;
    for (auto t = begin; t != end; ++t) {
      low = low.cwiseMin(balls_[*t].centre);
      high = high.cwiseMax(balls_[*t].centre);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = (first + last) / 2;
    std::nth_element(begin, order_.begin() + static_cast<std::ptrdiff_t>(middle * kGroup), end,
                     [&](Index a, Index b) { return balls_[a].centre[axis] < balls_[b].centre[axis]; });
    self(self, first, middle);
    self(self, middle, last);
  };
  halve(halve, 0, count);
}

void SkinDistance::move(std::span<const Vec3> positions) {
  positions_ = positions;
  const std::size_t n = triangles_.size();
  balls_.resize(n);
  normals_.resize(n);
  for (std::size_t t = 0; t < n; ++t) {
    const Vec3 &a = positions[triangles_[t][0]], &b = positions[triangles_[t][1]], &c = positions[triangles_[t][2]];
    const Vec3 centre = (a + b + c) / 3.0;
    balls_[t] = {
        centre,
        std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}))};
    normals_[t] = (b - a).cross(c - a).normalized();
  }
  if (groups_.empty()) group();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::span<const Index> own = std::span(order_).subspan(g * kGroup, std::min(kGroup, n - g * kGroup));
    Ball ball{Vec3::Zero(), 0.0};
    for (const Index t : own) ball.centre += balls_[t].centre / static_cast<double>(own.size());
    for (const Index t : own)
      ball.radius = std::max(ball.radius, (balls_[t].centre - ball.centre).norm() + balls_[t].radius);
    groups_[g] = ball;
  }
}

ClosestSkinPoint SkinDistance::closest(const Vec3 &x, const Vec3 &normal, double cosine, Index guess) const {
  ClosestSkinPoint out;
  double best = std::numeric_limits<double>::infinity();
  const bool isOriented = !normal.isZero(0.0);
  const auto isNear = [&](const Ball &ball) {
    // Rounding must not exclude a triangle at the same distance.
    const double reach = (best + ball.radius) * (1.0 + 1e-12);
    return (x - ball.centre).squaredNorm() <= reach * reach;
  };
  const auto visit = [&](Index t) {
    if (!isNear(balls_[t]) || (isOriented && !(normals_[t].dot(normal) >= cosine))) return;
    const auto &corners = triangles_[t];
    const Vec3 &a = positions_[corners[0]], &b = positions_[corners[1]], &c = positions_[corners[2]];
    const Vec3 weights = closestOfTriangle(x, a, b, c);
    const Vec3 at = weights[0] * a + weights[1] * b + weights[2] * c;
    const double distance = (x - at).norm();
    // Of several at the same distance the first one, independent of the guess and of the groups.
    if (distance > best || (distance == best && t >= out.triangle)) return;
    best = distance;
    out = {t, weights, at, normals_[t]};
  };
  if (guess < triangles_.size()) visit(guess);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!isNear(groups_[g])) continue;
    const std::size_t last = std::min((g + 1) * kGroup, order_.size());
    for (std::size_t k = g * kGroup; k < last; ++k) visit(order_[k]);
  }
  return out;
}

}  // namespace pointbased::detail
