// SPDX-License-Identifier: Apache-2.0
#include "contact/skin_surface.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "discretisation/interpolation_at.h"

namespace pointbased::detail {
namespace {

using Triangle = std::array<Index, 3>;
using Edge = std::pair<Index, Index>;  // ascending

constexpr Index kNone = 0xffffffffu;
// Rounds of halving, at most. Fewer: edges longer than longestEdge × 2^rounds remain too long.
constexpr int kMaxRounds = 8;
// Rounding, relative to the longest edge and to a weight of 1. Larger: vertices farther apart are welded.
constexpr double kSame = 1e-6;

Edge edgeOf(Index a, Index b) { return a < b ? Edge(a, b) : Edge(b, a); }

// Identifies how a point moves: its phyxels and rounded weights. Points at the same position may differ in it.
using Row = std::vector<std::pair<Index, long long>>;
Row rowOf(const Interpolation &vertices, Index v) {
  Row row;
  for (Index e = vertices.phyxels.offsets[v]; e < vertices.phyxels.offsets[v + 1]; ++e)
    if (const long long weight = std::llround(vertices.weights[e] / kSame); weight != 0)
      row.emplace_back(vertices.phyxels.indices[e], weight);
  std::sort(row.begin(), row.end());
  return row;
}

// At a crease, a displayed surface has one vertex per normal. Vertices that move alike are merged; otherwise the faces
// on both sides of an edge would not be adjacent.
void weld(const Interpolation &vertices, double size, std::vector<Triangle> &triangles) {
  std::vector<std::array<long long, 3>> positions;
  for (const Vec3 &x : vertices.positions)
    positions.push_back({std::llround(x[0] / (kSame * size)), std::llround(x[1] / (kSame * size)),
                         std::llround(x[2] / (kSame * size))});
  std::vector<Index> order(positions.size()), representative(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return positions[a] != positions[b] ? positions[a] < positions[b] : a < b; });
  std::vector<std::pair<Row, Index>> distinctRows;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && positions[order[end]] == positions[order[begin]]) ++end;
    representative[order[begin]] = order[begin];
    if (end - begin == 1) continue;
    distinctRows.clear();
    for (std::size_t k = begin; k < end; ++k) {
      Row row = rowOf(vertices, order[k]);
      const auto same =
          std::find_if(distinctRows.begin(), distinctRows.end(), [&](const auto &known) { return known.first == row; });
      representative[order[k]] = same == distinctRows.end() ? order[k] : same->second;
      if (same == distinctRows.end()) distinctRows.emplace_back(std::move(row), order[k]);
    }
  }
  for (Triangle &t : triangles)
    for (Index &v : t) v = representative[v];
  std::erase_if(triangles, [](const Triangle &t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

// Reduces the number of triangles; their vertices are a subset of the same points.
void coarsen(std::span<const Vec3> points, const SkinResolution &resolution, std::vector<Triangle> &triangles) {
  double area = 0.0;
  for (const auto &[a, b, c] : triangles) area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).norm();
  const double targetCount = area / (0.25 * std::sqrt(3.0) * resolution.edge * resolution.edge);
  if (!(targetCount < static_cast<double>(triangles.size()))) return;
  std::vector<std::array<float, 3>> positions;
  for (const Vec3 &x : points)
    positions.push_back({static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])});
  const float *x = positions.front().data();
  constexpr std::size_t kStride = sizeof(std::array<float, 3>);
  const float scale = meshopt_simplifyScale(x, positions.size(), kStride);
  std::vector<Triangle> fewer(triangles.size());
  fewer.resize(meshopt_simplify(fewer.front().data(), triangles.front().data(), 3 * triangles.size(), x,
                                positions.size(), kStride, 3 * static_cast<std::size_t>(targetCount),
                                static_cast<float>(resolution.deviation) / scale, 0, nullptr) /
               3);
  if (!fewer.empty()) triangles.swap(fewer);  // a skin without triangles could touch nothing
}

// Keeps the points that a triangle uses, in their order, and renumbers the corners of the triangles.
Interpolation used(Interpolation points, std::vector<Triangle> &triangles) {
  std::vector<Index> number(points.count(), kNone);
  for (const Triangle &t : triangles)
    for (const Index v : t) number[v] = 0;
  if (std::find(number.begin(), number.end(), kNone) == number.end()) return points;
  Interpolation out;
  out.phyxels.offsets.assign(1, 0);
  const bool ranks = !points.rank.empty();
  for (Index p = 0; p < number.size(); ++p) {
    if (number[p] == kNone) continue;
    number[p] = static_cast<Index>(out.count());
    out.positions.push_back(points.positions[p]);
    for (Index e = points.phyxels.offsets[p]; e < points.phyxels.offsets[p + 1]; ++e) {
      out.phyxels.indices.push_back(points.phyxels.indices[e]);
      out.weights.push_back(points.weights[e]);
      out.gradients.push_back(points.gradients[e]);
    }
    out.phyxels.offsets.push_back(static_cast<Index>(out.phyxels.indices.size()));
    if (!ranks) continue;
    const bool isWhole = points.rank[p] == 3;
    out.rank.push_back(points.rank[p]);
    out.frameOf.push_back(isWhole ? StencilSet::kNoFrame : static_cast<Index>(out.frames.size()));
    if (isWhole) continue;
    out.frames.push_back(points.frames[points.frameOf[p]]);
    out.offsets.push_back(points.offsets[points.frameOf[p]]);
  }
  for (Triangle &t : triangles)
    for (Index &v : t) v = number[v];
  return out;
}

// Halves edges that are too long in both adjacent triangles, so that no gap opens.
void divideLongEdges(std::vector<Vec3> &points, std::vector<Triangle> &triangles, double longest) {
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<Edge> halves;
    const auto isLong = [&](Index a, Index b) { return (points[a] - points[b]).norm() > longest * (1.0 + 1e-9); };
    for (const Triangle &t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        if (isLong(t[k], t[(k + 1) % 3])) halves.push_back(edgeOf(t[k], t[(k + 1) % 3]));
    if (halves.empty()) return;
    std::sort(halves.begin(), halves.end());
    halves.erase(std::unique(halves.begin(), halves.end()), halves.end());
    const auto first = static_cast<Index>(points.size());
    for (const auto &[a, b] : halves) points.emplace_back(0.5 * (points[a] + points[b]));
    const auto middleOf = [&](Index a, Index b) {
      const auto found = std::lower_bound(halves.begin(), halves.end(), edgeOf(a, b));
      return found == halves.end() || *found != edgeOf(a, b) ? kNone
                                                             : first + static_cast<Index>(found - halves.begin());
    };
    std::vector<Triangle> divided;
    for (const Triangle &t : triangles) {
      std::array<Index, 3> m{};  // midpoint of the edge from corner k to the next
      int halved = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        m[k] = middleOf(t[k], t[(k + 1) % 3]);
        halved += m[k] != kNone ? 1 : 0;
      }
      if (halved == 3) {
        divided.push_back({m[0], m[1], m[2]});
        for (std::size_t k = 0; k < 3; ++k) divided.push_back({t[k], m[k], m[(k + 2) % 3]});
        continue;
      }
      if (halved == 0) {
        divided.push_back(t);
        continue;
      }
      // Rotated so that the first edge is halved and the last one is not.
      std::size_t k = 0;
      while (m[k] == kNone || m[(k + 2) % 3] != kNone) ++k;
      const Index a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
      if (halved == 1) {
        divided.push_back({a, ab, c});
        divided.push_back({ab, b, c});
        continue;
      }
      divided.push_back({ab, b, bc});
      // The remaining quadrilateral is split along its shorter diagonal.
      if ((points[a] - points[bc]).squaredNorm() <= (points[ab] - points[c]).squaredNorm()) {
        divided.push_back({a, ab, bc});
        divided.push_back({a, bc, c});
      } else {
        divided.push_back({a, ab, c});
        divided.push_back({ab, bc, c});
      }
    }
    triangles.swap(divided);
  }
}

}  // namespace

SkinSurface makeSkinSurface(Interpolation vertices, std::vector<Triangle> triangles, const SkinResolution &resolution) {
  weld(vertices, resolution.longestEdge, triangles);
  if (resolution.edge > 0.0 && !triangles.empty()) {
    coarsen(vertices.positions, resolution, triangles);
    vertices = used(std::move(vertices), triangles);
  }
  SkinSurface out{std::move(vertices), {}, std::move(triangles)};
  std::vector<Vec3> points = out.points.positions;
  divideLongEdges(points, out.triangles, resolution.longestEdge);
  out.added.assign(points.begin() + static_cast<std::ptrdiff_t>(out.points.count()), points.end());
  return out;
}

void append(const Interpolation &more, Interpolation &to) {
  const std::size_t had = to.count(), ranked = to.frames.size();
  const bool ranks = !to.rank.empty() || !more.rank.empty();
  const auto shift = static_cast<Index>(to.phyxels.indices.size());
  to.positions.insert(to.positions.end(), more.positions.begin(), more.positions.end());
  to.phyxels.indices.insert(to.phyxels.indices.end(), more.phyxels.indices.begin(), more.phyxels.indices.end());
  for (std::size_t p = 0; p < more.count(); ++p) to.phyxels.offsets.push_back(shift + more.phyxels.offsets[p + 1]);
  to.weights.insert(to.weights.end(), more.weights.begin(), more.weights.end());
  to.gradients.insert(to.gradients.end(), more.gradients.begin(), more.gradients.end());
  if (!ranks) return;
  to.rank.resize(had, 3);
  to.frameOf.resize(had, StencilSet::kNoFrame);
  for (std::size_t p = 0; p < more.count(); ++p) {
    const int rank = rankOf(more, p);
    to.rank.push_back(static_cast<std::uint8_t>(rank));
    to.frameOf.push_back(rank < 3 ? static_cast<Index>(ranked + more.frameOf[p]) : StencilSet::kNoFrame);
  }
  to.frames.insert(to.frames.end(), more.frames.begin(), more.frames.end());
  to.offsets.insert(to.offsets.end(), more.offsets.begin(), more.offsets.end());
}

}  // namespace pointbased::detail
