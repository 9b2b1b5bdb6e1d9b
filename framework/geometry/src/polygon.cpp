// SPDX-License-Identifier: Apache-2.0
#include "polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace c3de::geometry {
namespace {

using Point2 = std::array<double, 2>;

double doubleArea(const Point2 &a, const Point2 &b, const Point2 &c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Signed height of a triangle over its longest side, as a measure of its quality.
double signedHeight(const Point2 &a, const Point2 &b, const Point2 &c) {
  const auto squared = [](const Point2 &p, const Point2 &q) {
    return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
  };
  const double longest = std::max({squared(a, b), squared(b, c), squared(c, a)});
  return longest > 0.0 ? doubleArea(a, b, c) / std::sqrt(longest) : 0.0;
}

/// Coordinates in the polygon's mean plane (Newell's normal), counter-clockwise.
std::vector<Point2> project(std::span<const Vec3> vertices, std::span<const unsigned> corners) {
  Vec3 normal{};
  const Vec3 origin = vertices[corners[0]];
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal = normal + cross(vertices[corners[i]] - origin, vertices[corners[(i + 1) % corners.size()]] - origin);
  // Dropping the normal's largest component keeps the shape and its sense of rotation.
  std::size_t drop = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[drop])) drop = k;
  std::size_t u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0.0) std::swap(u, v);
  std::vector<Point2> points(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    points[i] = {vertices[corners[i]][u] - origin[u], vertices[corners[i]][v] - origin[v]};
  return points;
}

/// Along the diagonal that gives the better triangles.
void splitQuad(std::span<const Point2> p, std::span<const unsigned> corners, std::vector<Triangle> &out) {
  const double along02 = std::min(signedHeight(p[0], p[1], p[2]), signedHeight(p[0], p[2], p[3]));
  const double along13 = std::min(signedHeight(p[1], p[2], p[3]), signedHeight(p[1], p[3], p[0]));
  if (along02 >= along13) {
    out.push_back({corners[0], corners[1], corners[2]});
    out.push_back({corners[0], corners[2], corners[3]});
  } else {
    out.push_back({corners[1], corners[2], corners[3]});
    out.push_back({corners[1], corners[3], corners[0]});
  }
}

/// The remaining corners of a polygon during ear clipping.
class EarCutter {
 public:
  explicit EarCutter(std::span<const Point2> points) : p_(points), next_(points.size()), previous_(points.size()) {
    const std::size_t n = p_.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::size_t i = 0; i < n; ++i)
      if (doubleArea(p_[previous_[i]], p_[i], p_[next_[i]]) < 0.0) reflex_.push_back(i);
  }

  [[nodiscard]] bool isConvex() const { return reflex_.empty(); }

  void cutAll(std::span<const unsigned> corners, std::vector<Triangle> &out) {
    const auto add = [&](std::size_t i) { out.push_back({corners[previous_[i]], corners[i], corners[next_[i]]}); };
    std::size_t current = 0;
    for (std::size_t left = p_.size(); left > 3; --left) {
      const std::size_t ear = findEar(current, left);
      add(ear);
      next_[previous_[ear]] = next_[ear];
      previous_[next_[ear]] = previous_[ear];
      current = next_[next_[ear]];  // not the neighbour, which would result in a fan of slivers
      next_[ear] = p_.size();       // marks it as clipped
    }
    add(current);
  }

 private:
  /// The next ear from `current` on; if there is none, the corner with the best triangle.
  [[nodiscard]] std::size_t findEar(std::size_t current, std::size_t left) const {
    std::size_t ear = current, best = current;
    double bestHeight = height(best);
    for (std::size_t k = 0; k < left; ++k, ear = next_[ear]) {
      if (isEar(ear)) return ear;
      if (height(ear) > bestHeight) {
        best = ear;
        bestHeight = height(ear);
      }
    }
    return best;  // self-intersecting or without area: any choice covers it
  }

  /// A convex corner whose triangle contains no reflex corner.
  [[nodiscard]] bool isEar(std::size_t i) const {
    const Point2 &a = p_[previous_[i]], &b = p_[i], &c = p_[next_[i]];
    if (doubleArea(a, b, c) <= 0.0) return false;
    for (std::size_t r : reflex_) {
      if (r == i || r == previous_[i] || r == next_[i] || next_[r] == p_.size()) continue;
      if (doubleArea(a, b, p_[r]) >= 0.0 && doubleArea(b, c, p_[r]) >= 0.0 && doubleArea(c, a, p_[r]) >= 0.0)
        return false;
    }
    return true;
  }

  [[nodiscard]] double height(std::size_t i) const { return signedHeight(p_[previous_[i]], p_[i], p_[next_[i]]); }

  std::span<const Point2> p_;
  std::vector<std::size_t> next_, previous_, reflex_;
};

}  // namespace

bool triangulatePolygon(std::span<const Vec3> vertices, std::span<const unsigned> corners, std::vector<Triangle> &out) {
  constexpr std::size_t kMaxConcaveCorners = 4096;
  if (corners.size() == 3) {
    out.push_back({corners[0], corners[1], corners[2]});
    return true;
  }
  const std::vector<Point2> p = project(vertices, corners);
  if (corners.size() == 4) {
    splitQuad(p, corners, out);
    return true;
  }
  EarCutter cutter(p);
  if (!cutter.isConvex() && corners.size() > kMaxConcaveCorners) return false;
  cutter.cutAll(corners, out);
  return true;
}

}  // namespace c3de::geometry
