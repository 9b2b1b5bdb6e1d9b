// SPDX-License-Identifier: Apache-2.0
// Closest points on a moving skin. Private to the core.
#pragma once

#include <array>

#include "pointbased/types.h"

namespace pointbased::detail {

/// Point of a skin that is closest to a given one.
struct ClosestSkinPoint {
  static constexpr Index kNone = 0xffffffffu;
  Index triangle = kNone;       ///< kNone: no triangle faces the point
  Vec3 weights = Vec3::Zero();  ///< of its three vertices
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< unit, of the triangle
};

/// Weights of the corners of the point of a triangle that is closest to x.
/// @source  Ericson, Real-Time Collision Detection, 2005, ch. 5.1.5 (regions of a triangle)
[[nodiscard]] Vec3 closestOfTriangle(const Vec3 &x, const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// Triangles of a skin in two levels of bounding spheres: groups of neighbours, and the triangles themselves.
class SkinDistance {
 public:
  /// @param triangles  must outlive the object
  explicit SkinDistance(std::span<const std::array<Index, 3>> triangles) : triangles_(triangles) {}
  /// @param positions  [vertices]; must outlive the queries
  void move(std::span<const Vec3> positions);
  /// @param normal    of the point, or zero
  /// @param cosine    least n · n of a triangle that counts, if there is a normal
  /// @param guess     a triangle near the point, or kNone: only speeds the search up
  [[nodiscard]] ClosestSkinPoint closest(const Vec3 &x, const Vec3 &normal, double cosine, Index guess) const;

 private:
  std::span<const std::array<Index, 3>> triangles_;
  std::span<const Vec3> positions_;
  struct Ball {
    Vec3 centre;
    double radius;
  };
  void group();

  std::vector<Index> order_;  // triangles; consecutive ones are a group
  std::vector<Ball> groups_;
  std::vector<Ball> balls_;  // [triangles]
  std::vector<Vec3> normals_;
};

}  // namespace pointbased::detail
