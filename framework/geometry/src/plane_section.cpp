// SPDX-License-Identifier: Apache-2.0
#include "c3de/geometry/plane_section.h"

#include <algorithm>
#include <cstdint>

namespace c3de::geometry {
namespace {

using Key = std::uint64_t;  // an edge: the smaller vertex in the upper half

Key edgeKey(unsigned a, unsigned b) { return (Key{std::min(a, b)} << 32) | std::max(a, b); }

/// A piece of a curve through one triangle, from the edge where it enters to the edge where it leaves.
struct Piece {
  Key from, to;
};

template <class Point>
Vec3 toVec3(const Point &p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// Follows pieces from end to end; `pieces` is sorted by `from`.
class Joiner {
 public:
  Joiner(std::vector<Piece> pieces, std::vector<Key> ends) : pieces_(std::move(pieces)), ends_(std::move(ends)) {
    isUsed_.assign(pieces_.size(), 0);
  }

  template <class PointOf>
  std::vector<Polyline> join(const PointOf &pointOf) {
    std::vector<Polyline> curves;
    // Curves of an open surface begin at an edge where no other piece ends.
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (!isUsed_[i] && !std::binary_search(ends_.begin(), ends_.end(), pieces_[i].from))
        curves.push_back(follow(i, pointOf));
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      if (!isUsed_[i]) curves.push_back(follow(i, pointOf));
    return curves;
  }

 private:
  template <class PointOf>
  Polyline follow(std::size_t at, const PointOf &pointOf) {
    Polyline curve;
    const Key begin = pieces_[at].from;
    for (;;) {
      isUsed_[at] = 1;
      curve.points.push_back(pointOf(pieces_[at].from));
      const Key end = pieces_[at].to;
      if (end == begin) {
        curve.isClosed = true;
        return curve;
      }
      auto next =
          std::lower_bound(pieces_.begin(), pieces_.end(), end, [](const Piece &p, Key key) { return p.from < key; });
      while (next != pieces_.end() && next->from == end && isUsed_[static_cast<std::size_t>(next - pieces_.begin())])
        ++next;
      if (next == pieces_.end() || next->from != end) {
        curve.points.push_back(pointOf(end));
        return curve;
      }
      at = static_cast<std::size_t>(next - pieces_.begin());
    }
  }

  std::vector<Piece> pieces_;
  std::vector<Key> ends_;
  std::vector<std::uint8_t> isUsed_;
};

template <class Point>
std::vector<Polyline> section(std::span<const Point> positions, std::span<const Triangle> triangles, const Vec3 &at,
                              const Vec3 &normal) {
  std::vector<double> distance(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) distance[i] = dot(toVec3(positions[i]) - at, normal);
  const auto isInFront = [&](unsigned v) { return distance[v] >= 0.0; };

  std::vector<Piece> pieces;
  for (const Triangle &t : triangles) {
    if (std::max({t[0], t[1], t[2]}) >= positions.size()) continue;
    Piece piece{};
    bool isCut = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned a = t[k], b = t[(k + 1) % 3];
      if (isInFront(a) == isInFront(b)) continue;
      isCut = true;
      // With the material on the left: the edge that goes behind the plane begins the piece.
      (isInFront(a) ? piece.from : piece.to) = edgeKey(a, b);
    }
    if (isCut) pieces.push_back(piece);
  }
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece &p, const Piece &q) { return p.from < q.from || (p.from == q.from && p.to < q.to); });
  std::vector<Key> ends;
  ends.reserve(pieces.size());
  for (const Piece &piece : pieces) ends.push_back(piece.to);
  std::sort(ends.begin(), ends.end());

  return Joiner(std::move(pieces), std::move(ends)).join([&](Key key) {
    const auto a = static_cast<std::size_t>(key >> 32), b = static_cast<std::size_t>(key & 0xffffffffu);
    const double t = distance[a] / (distance[a] - distance[b]);
    const Vec3 p = toVec3(positions[a]);
    return p + t * (toVec3(positions[b]) - p);
  });
}

}  // namespace

std::vector<Polyline> planeSection(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                   const Vec3 &planePoint, const Vec3 &planeNormal) {
  return section(positions, triangles, planePoint, planeNormal);
}

std::vector<Polyline> planeSection(std::span<const std::array<float, 3>> positions, std::span<const Triangle> triangles,
                                   const Vec3 &planePoint, const Vec3 &planeNormal) {
  return section(positions, triangles, planePoint, planeNormal);
}

double sectionArea(std::span<const Polyline> section, const Vec3 &planeNormal) {
  double area = 0.0;
  for (const Polyline &curve : section)
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const Vec3 a = curve.points[i] - curve.points[0],
                 b = curve.points[(i + 1) % curve.points.size()] - curve.points[0];
      area += 0.5 * dot(cross(a, b), planeNormal);
    }
  return area / norm(planeNormal);
}

}  // namespace c3de::geometry
