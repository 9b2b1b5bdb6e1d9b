// SPDX-License-Identifier: Apache-2.0
#include "pointbased/neighborhood.h"

#include <algorithm>
#include <cmath>

#include "base/point_tree.h"

namespace pointbased {

Neighborhoods findNeighborhoods(std::span<const Vec3> positions, const NeighborChoice &choice, double spacing,
                                const ParallelFor &parallelFor) {
  const std::size_t n = positions.size();
  Neighborhoods out;
  out.supportRadii.assign(n, choice.support * spacing);
  if (n == 0) return out;
  const PointTree tree(positions);

  if (choice.count > 0) {
    const std::size_t wanted = std::min<std::size_t>(n, static_cast<std::size_t>(choice.count) + 1);
    parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
      std::vector<Index> indices(wanted);
      std::vector<double> squared(wanted);
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t found = tree.nearest(positions[i], wanted, indices.data(), squared.data());
        const double farthest = found > 0 ? std::sqrt(squared[found - 1]) : 0.0;
        out.supportRadii[i] = farthest > 0.0 ? kSupportMargin * farthest : spacing;
      }
    });
  }

  // Everybody within the support; a tie at the edge of "the nearest N" is taken whole, so the choice is symmetric on
  // lattices and does not depend on the order of the points.
  std::vector<std::vector<Index>> chosen(n);
  parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<Index, double>> found;
    for (std::size_t i = begin; i < end; ++i) {
      double radius = out.supportRadii[i];
      if (choice.count > 0) radius *= (1.0 + 1e-9) / kSupportMargin;
      tree.within(positions[i], radius, found);
      for (const auto &[j, squared] : found)
        if (j != i) chosen[i].push_back(j);
    }
  });
  std::vector<std::vector<Index>> both = chosen;
  for (std::size_t i = 0; i < n; ++i)
    for (const Index j : chosen[i]) both[j].push_back(static_cast<Index>(i));
  out.neighbors.offsets.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::sort(both[i].begin(), both[i].end());
    both[i].erase(std::unique(both[i].begin(), both[i].end()), both[i].end());
    out.neighbors.offsets[i + 1] = out.neighbors.offsets[i] + static_cast<Index>(both[i].size());
  }
  out.neighbors.indices.reserve(out.neighbors.offsets[n]);
  for (const auto &row : both) out.neighbors.indices.insert(out.neighbors.indices.end(), row.begin(), row.end());
  return out;
}

}  // namespace pointbased
