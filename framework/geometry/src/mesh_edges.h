// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "c3de/geometry/triangle_mesh.h"

namespace c3de::geometry {

/// One side of one triangle. Sides of one edge are adjacent after sortedSides().
struct TriangleSide {
  unsigned low = 0, high = 0;  ///< vertices, low < high
  unsigned triangle = 0;
  bool forward = false;  ///< the triangle runs from low to high
};

/// Three sides per triangle, ordered by edge, then triangle. Sides from a vertex to itself are omitted.
[[nodiscard]] std::vector<TriangleSide> sortedSides(std::span<const Triangle> triangles);

/// Calls visit(std::span<const TriangleSide>) once per edge.
template <class Visit>
void forEachEdge(std::span<const TriangleSide> sides, Visit &&visit) {
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high) ++end;
    visit(sides.subspan(begin, end - begin));
  }
}

/// Equally many triangles in both directions: the surface does not end at this edge.
[[nodiscard]] bool isBalanced(std::span<const TriangleSide> edge);

/// Groups 0 … count-1 of joined elements.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n);
  unsigned find(unsigned i);
  void join(unsigned i, unsigned j);
  /// Group number per element, in order of first appearance; returns the number of groups.
  std::size_t number(std::vector<unsigned> &group);

 private:
  std::vector<unsigned> parent_;
};

/// For every vertex the first one at exactly the same position.
[[nodiscard]] std::vector<unsigned> firstAtSamePosition(std::span<const Vec3> vertices);

/// A group of adjacent edges at which the surface ends.
struct Hole {
  std::size_t edges = 0;
  double perimeter_mm = 0.0;
  double area_mm2 = 0.0;  ///< of the fan over its edges: about the area of a lid
  Vec3 centre{};
};
/// Largest first. An edge belongs to a hole if an odd number of triangles meet there.
[[nodiscard]] std::vector<Hole> findHoles(const TriangleMesh &mesh, std::span<const TriangleSide> sides);

/// Fraction of the surface that lids over all holes would add; above kMaxHoleShare a surface counts as open.
[[nodiscard]] double holeShare(std::span<const Hole> holes, double area_mm2);

/// At the centre of an organ with a hole of this fraction, the winding number is still well above one half.
inline constexpr double kMaxHoleShare = 0.05;

}  // namespace c3de::geometry
