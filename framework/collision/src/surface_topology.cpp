// SPDX-License-Identifier: Apache-2.0
#include "surface_topology.h"

#include <algorithm>
#include <utility>

namespace c3de::collision {
namespace {

bool everyEdgeIsBalanced(std::span<const Triangle> triangles) {
  struct Side {
    unsigned low, high;
    int direction;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (const Triangle &t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const unsigned a = t[k], b = t[(k + 1) % 3];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  const auto edgeLess = [](const Side &p, const Side &q) { return p.low != q.low ? p.low < q.low : p.high < q.high; };
  std::sort(sides.begin(), sides.end(), edgeLess);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    int sum = 0;
    for (; end < sides.size() && !edgeLess(sides[begin], sides[end]); ++end) sum += sides[end].direction;
    if (sum != 0) return false;
  }
  return !sides.empty();
}

}  // namespace

SurfaceTopology::SurfaceTopology(std::size_t vertexCount, std::span<const Triangle> triangles)
    : begin_(vertexCount + 1, 0), list_(3 * triangles.size()), closed_(everyEdgeIsBalanced(triangles)) {
  for (const Triangle &t : triangles)
    for (unsigned v : t) ++begin_[v + 1];
  for (std::size_t v = 0; v < vertexCount; ++v) begin_[v + 1] += begin_[v];
  std::vector<std::size_t> fill(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (unsigned v : triangles[t]) list_[fill[v]++] = t;
}

}  // namespace c3de::collision
