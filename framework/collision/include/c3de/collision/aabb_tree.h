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

/// A tree of axis-aligned boxes over a triangle mesh, on FCL's BVHModel with our own traversal: FCL has no ray query,
/// and its collide() copies the whole model per query for this kind of box.
///
/// Lengths are in whatever unit the vertices have. Const members may run on several threads at once; refit() and
/// rebuild() need the tree to themselves.
class AabbTree {
 public:
  /// The error names the triangle or vertex that is out of range or not finite.
  [[nodiscard]] static Expected<AabbTree> build(std::span<const Vec3> vertices, std::span<const Triangle> triangles);
  AabbTree(AabbTree &&) noexcept;
  AabbTree &operator=(AabbTree &&) noexcept;
  ~AabbTree();

  /// New positions for the same triangles: boxes follow, the tree's shape stays. O(n).
  /// Positions that are refused leave the tree as it was.
  [[nodiscard]] Expected<void> refit(std::span<const Vec3> vertices);
  /// A new tree over the present positions, for when refitted boxes have grown. O(n log n).
  void rebuild();

  /// First triangle, seen from either side, with t in [0, tMax]; on a tie the one with the smallest index. Rays through
  /// edges and corners hit one of the triangles there. None for a zero or non-finite direction.
  [[nodiscard]] RayHit ray(const Vec3 &origin, const Vec3 &direction,
                           double tMax = std::numeric_limits<double>::infinity()) const;
  [[nodiscard]] RayHit segment(const Vec3 &from, const Vec3 &to) const;  ///< t in [0, 1]
  /// Closest point of the surface within maxDistance (inclusive), on a tie that of the triangle with the smallest
  /// index.
  [[nodiscard]] ClosestPoint closest(const Vec3 &point,
                                     double maxDistance = std::numeric_limits<double>::infinity()) const;
  /// Triangles that meet the ball, in ascending order; `out` is replaced.
  void sphere(const Vec3 &centre, double radius, std::vector<std::uint32_t> &out) const;

  /// Pairs of a triangle of this tree and one of another, or of this one itself, that are no farther apart than a distance
  /// >= 0 (0: they meet), in ascending order; `out` is replaced. Within one tree each pair once, the smaller index first,
  /// without those that share a vertex.
  void pairs(const AabbTree &other, double distance, std::vector<std::array<std::uint32_t, 2>> &out) const;

  /// Every edge is run through as often one way as the other (two triangles that face the same side, as a rule):
  /// distances are signed. Vertices count as different even at equal positions.
  [[nodiscard]] bool isClosed() const;
  [[nodiscard]] std::size_t triangleCount() const;
  [[nodiscard]] std::size_t vertexCount() const;

 private:
  struct Impl;
  explicit AabbTree(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::collision
