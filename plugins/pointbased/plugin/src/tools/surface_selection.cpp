// SPDX-License-Identifier: Apache-2.0
#include "tools/surface_selection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pointbased {
namespace {

constexpr double kAngleTolerance = 1e-9;  // of a cosine: equal normals are equal at an angle of 0 as well

Vec3 pointOf(const Vec3f &x) { return {x[0], x[1], x[2]}; }

Vec3 unitNormalOf(std::span<const Vec3> x, const SurfaceTriangle &t) {
  const Vec3 n = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : Vec3(Vec3::Zero());
}

/// Cuts a convex polygon at a plane: what remains has side · x ≤ limit.
void clip(std::vector<Vec3> &polygon, const Vec3 &side, double limit) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double u = side.dot(a) - limit, v = side.dot(b) - limit;
    if (u <= 0.0) out.push_back(a);
    if ((u < 0.0 && v > 0.0) || (u > 0.0 && v < 0.0)) out.push_back(a + u / (u - v) * (b - a));
  }
  polygon = std::move(out);
}

}  // namespace

TriangleNeighbours::TriangleNeighbours(std::span<const SurfaceTriangle> triangles) {
  struct Edge {
    std::uint32_t low, high, triangle;
    [[nodiscard]] bool joins(const Edge &other) const { return low == other.low && high == other.high; }
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, t});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge &a, const Edge &b) {
    return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
  });
  std::vector<std::array<std::uint32_t, 2>> pairs;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].joins(edges[begin])) ++end;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = begin; j < end; ++j)
        if (i != j) pairs.push_back({edges[i].triangle, edges[j].triangle});
  }
  std::sort(pairs.begin(), pairs.end());
  first_.assign(triangles.size() + 1, 0);
  for (const auto &[triangle, other] : pairs) {
    ++first_[triangle + 1];
    all_.push_back(other);
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) first_[t + 1] += first_[t];
}

std::vector<std::uint32_t> faceAround(std::span<const Vec3> positions, std::span<const SurfaceTriangle> triangles,
                                      const TriangleNeighbours &neighbours, std::uint32_t triangle, FaceBorder border,
                                      double angle_deg) {
  const double least = std::cos(std::clamp(angle_deg, 0.0, 180.0) * std::numbers::pi / 180.0) - kAngleTolerance;
  const Vec3 picked = unitNormalOf(positions, triangles[triangle]);
  std::vector<bool> isFound(triangles.size(), false);
  isFound[triangle] = true;
  std::vector<std::uint32_t> next{triangle}, face{triangle};
  while (!next.empty()) {
    const std::uint32_t t = next.back();
    next.pop_back();
    const Vec3 normal = border == FaceBorder::tilt ? picked : unitNormalOf(positions, triangles[t]);
    for (const std::uint32_t other : neighbours.of(t)) {
      if (isFound[other] || unitNormalOf(positions, triangles[other]).dot(normal) < least) continue;
      isFound[other] = true;
      next.push_back(other);
      face.push_back(other);
    }
  }
  std::sort(face.begin(), face.end());
  return face;
}

Vec3 centreOf(std::span<const Vec3f> x, const SurfaceTriangle &t) {
  return (pointOf(x[t[0]]) + pointOf(x[t[1]]) + pointOf(x[t[2]])) / 3.0;
}

double areaOf(std::span<const Vec3f> x, const SurfaceTriangle &t) {
  const Vec3 a = pointOf(x[t[0]]);
  return 0.5 * (pointOf(x[t[1]]) - a).cross(pointOf(x[t[2]]) - a).norm();
}

std::vector<std::uint32_t> trianglesInRect(std::span<const Vec3f> positions, std::span<const SurfaceTriangle> triangles,
                                           const ViewFrame &frame, const PixelRect &rect, bool facesViewer) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Vec3 centre = centreOf(positions, triangles[t]);
    const ViewFrame::Pixel pixel = frame.project(centre);
    if ((frame.isPerspective() && !(pixel.depth > 0.0)) || !rect.contains(pixel.x, pixel.y)) continue;
    if (facesViewer) {
      const Vec3 a = pointOf(positions[triangles[t][0]]);
      const Vec3 normal = (pointOf(positions[triangles[t][1]]) - a).cross(pointOf(positions[triangles[t][2]]) - a);
      if (normal.dot(frame.ray(pixel.x, pixel.y).direction) >= 0.0) continue;
    }
    out.push_back(t);
  }
  return out;
}

std::vector<std::uint32_t> trianglesInSlab(std::span<const Vec3f> positions, std::span<const SurfaceTriangle> triangles,
                                           const ViewFrame &frame, const PixelRect &rect, double low, double high) {
  std::vector<std::uint32_t> out;
  std::vector<Vec3> polygon;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    polygon.clear();
    for (const std::uint32_t corner : triangles[t]) {
      const ViewFrame::Pixel pixel = frame.project(pointOf(positions[corner]));
      polygon.emplace_back(pixel.x, pixel.y, pixel.depth);
    }
    clip(polygon, Vec3::UnitX(), rect.right);
    clip(polygon, -Vec3::UnitX(), -rect.left);
    clip(polygon, Vec3::UnitY(), rect.bottom);
    clip(polygon, -Vec3::UnitY(), -rect.top);
    clip(polygon, Vec3::UnitZ(), high);
    clip(polygon, -Vec3::UnitZ(), -low);
    if (!polygon.empty()) out.push_back(t);
  }
  return out;
}

}  // namespace pointbased
