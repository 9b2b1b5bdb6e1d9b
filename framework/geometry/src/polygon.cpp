// SPDX-License-Identifier: Apache-2.0
#include "polygon.h"

#include <algorithm>
#include <array>

namespace c3de::geometry {
namespace {

using Point2 = std::array<double, 2>;

double doubleArea(const Point2 &a, const Point2 &b, const Point2 &c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Height of a triangle over its longest side, signed: how well it is shaped.
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

}  // namespace

bool triangulatePolygon(std::span<const Vec3> vertices, std::span<const unsigned> corners, std::vector<Triangle> &out) {
  constexpr std::size_t kMaxConcaveCorners = 4096;
  const std::size_t n = corners.size();
  if (n == 3) {
    out.push_back({corners[0], corners[1], corners[2]});
    return true;
  }
  const std::vector<Point2> p = project(vertices, corners);
  if (n == 4) {
    const double along02 = std::min(signedHeight(p[0], p[1], p[2]), signedHeight(p[0], p[2], p[3]));
    const double along13 = std::min(signedHeight(p[1], p[2], p[3]), signedHeight(p[1], p[3], p[0]));
    if (along02 >= along13) {
      out.push_back({corners[0], corners[1], corners[2]});
      out.push_back({corners[0], corners[2], corners[3]});
    } else {
      out.push_back({corners[1], corners[2], corners[3]});
      out.push_back({corners[1], corners[3], corners[0]});
    }
    return true;
  }

  std::vector<std::size_t> next(n), previous(n), reflex;
  for (std::size_t i = 0; i < n; ++i) {
    next[i] = (i + 1) % n;
    previous[i] = (i + n - 1) % n;
  }
  for (std::size_t i = 0; i < n; ++i)
    if (doubleArea(p[previous[i]], p[i], p[next[i]]) < 0.0) reflex.push_back(i);
  if (!reflex.empty() && n > kMaxConcaveCorners) return false;

  // An ear is a convex corner whose triangle holds no reflex corner.
  const auto isEar = [&](std::size_t i) {
    const Point2 &a = p[previous[i]], &b = p[i], &c = p[next[i]];
    if (doubleArea(a, b, c) <= 0.0) return false;
    for (std::size_t r : reflex) {
      if (r == i || r == previous[i] || r == next[i] || next[r] == n) continue;
      if (doubleArea(a, b, p[r]) >= 0.0 && doubleArea(b, c, p[r]) >= 0.0 && doubleArea(c, a, p[r]) >= 0.0) return false;
    }
    return true;
  };
  std::size_t current = 0;
  for (std::size_t left = n; left > 3; --left) {
    std::size_t ear = current, best = current;
    double bestHeight = signedHeight(p[previous[best]], p[best], p[next[best]]);
    bool found = false;
    for (std::size_t k = 0; k < left; ++k, ear = next[ear]) {
      if (isEar(ear)) {
        found = true;
        break;
      }
      const double height = signedHeight(p[previous[ear]], p[ear], p[next[ear]]);
      if (height > bestHeight) {
        best = ear;
        bestHeight = height;
      }
    }
    if (!found) ear = best;  // crosses itself or has no area: any choice covers it
    out.push_back({corners[previous[ear]], corners[ear], corners[next[ear]]});
    next[previous[ear]] = next[ear];
    previous[next[ear]] = previous[ear];
    current = next[next[ear]];  // not the neighbour: a fan of slivers would result
    next[ear] = n;              // marks it as cut off
  }
  out.push_back({corners[previous[current]], corners[current], corners[next[current]]});
  return true;
}

}  // namespace c3de::geometry
