// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/vec.h"

namespace c3de::collision {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

struct RayHit {
  double t = -1.0;  ///< along the direction (not normalised); < 0: none
  std::uint32_t triangle = kNoTriangle;
  Vec3 bary{};  ///< weights of the triangle's corners

  [[nodiscard]] bool isHit() const { return triangle != kNoTriangle; }
};

struct ClosestPoint {
  Vec3 point{};
  Vec3 normal{};  ///< unit, angle-weighted pseudonormal of the closest face, edge or vertex
  double distance = std::numeric_limits<double>::infinity();  ///< negative inside a closed, oriented mesh
  std::uint32_t triangle = kNoTriangle;
  Vec3 bary{};

  [[nodiscard]] bool isFound() const { return triangle != kNoTriangle; }
};

/// A tree of axis-aligned boxes over a triangle mesh, based on FCL's BVHModel with a custom traversal: FCL has no ray
/// query, and its collide() copies the whole model per query for this kind of box.
///
/// Lengths are in the unit of the vertices. Const members may run on several threads at once; refit() and rebuild()
/// need exclusive access to the tree.
class AabbTree {
 public:
  /// The error names the triangle or vertex that is out of range or not finite.
  [[nodiscard]] static Expected<AabbTree> build(std::span<const Vec3> vertices, std::span<const Triangle> triangles);
  AabbTree(AabbTree &&) noexcept;
  AabbTree &operator=(AabbTree &&) noexcept;
  ~AabbTree();

  /// New positions for the same triangles: the boxes are updated, the structure of the tree is unchanged. O(n).
  /// Refused positions leave the tree unchanged.
  [[nodiscard]] Expected<void> refit(std::span<const Vec3> vertices);
  /// Builds a new tree for the present positions, for when refitted boxes have grown. O(n log n).
  void rebuild();

  /// First intersected triangle, from either side, with t in [0, tMax]; on a tie the one with the smallest index. Rays
  /// through edges and corners hit one of the triangles there. None for a zero or non-finite direction.
  [[nodiscard]] RayHit ray(const Vec3 &origin, const Vec3 &direction,
                           double tMax = std::numeric_limits<double>::infinity()) const;
  [[nodiscard]] RayHit segment(const Vec3 &from, const Vec3 &to) const;  ///< t in [0, 1]
  /// Closest point of the surface within maxDistance (inclusive), on a tie that of the triangle with the smallest
  /// index.
  [[nodiscard]] ClosestPoint closest(const Vec3 &point,
                                     double maxDistance = std::numeric_limits<double>::infinity()) const;
  /// Triangles that intersect the ball, in ascending order; `out` is replaced.
  void sphere(const Vec3 &centre, double radius, std::vector<std::uint32_t> &out) const;

  /// Pairs of a triangle of this tree and one of another, or of the same tree, whose distance is at most `distance` >=
  /// 0 (0: they intersect), in ascending order; `out` is replaced. Within one tree each pair occurs once, the smaller
  /// index first, without pairs that share a vertex.
  void pairs(const AabbTree &other, double distance, std::vector<std::array<std::uint32_t, 2>> &out) const;

  /// Every edge is traversed equally often in both directions (usually by two consistently oriented triangles):
  /// distances are signed. Vertices at equal positions count as different.
  [[nodiscard]] bool isClosed() const;
  [[nodiscard]] std::size_t triangleCount() const;
  [[nodiscard]] std::size_t vertexCount() const;

 private:
  struct Impl;
  explicit AabbTree(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::collision
