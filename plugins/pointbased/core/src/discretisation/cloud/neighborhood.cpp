// SPDX-License-Identifier: Apache-2.0
#include "pointbased/neighborhood.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/cancellation_poll.h"
#include "base/point_tree.h"

namespace pointbased {
namespace {

Csr rowsOf(const std::vector<std::vector<Index>> &rows) {
  Csr out;
  out.offsets.reserve(rows.size() + 1);
  for (const std::vector<Index> &row : rows) out.offsets.push_back(out.offsets.back() + static_cast<Index>(row.size()));
  out.indices.reserve(out.offsets.back());
  for (const std::vector<Index> &row : rows) out.indices.insert(out.indices.end(), row.begin(), row.end());
  return out;
}

}  // namespace

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

  // All phyxels within the support. Ties at the limit of "the nearest N" are all included, so the choice is symmetric
  // on lattices and does not depend on the order of the points.
  std::vector<std::vector<Index>> chosen(n);
  parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<Index, double>> found;
    for (std::size_t i = begin; i < end; ++i) {
      double radius = out.supportRadii[i];
      if (choice.count > 0) radius *= (1.0 + 1e-9) / kSupportMargin;
      tree.within(positions[i], radius, found);
      for (const auto &[j, squared] : found)
        if (j != i) chosen[i].push_back(j);
      std::sort(chosen[i].begin(), chosen[i].end());
    }
  });
  // The phyxels that have chosen each phyxel, ascending.
  detail::CancellationPoll look(parallelFor);
  Csr chosenBy;
  chosenBy.offsets.assign(n + 1, 0);
  for (const std::vector<Index> &row : chosen)
    for (const Index j : row) ++chosenBy.offsets[j + 1];
  for (std::size_t i = 0; i < n; ++i) chosenBy.offsets[i + 1] += chosenBy.offsets[i];
  chosenBy.indices.resize(chosenBy.offsets[n]);
  std::vector<Index> next(chosenBy.offsets.begin(), chosenBy.offsets.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    look();
    for (const Index j : chosen[i]) chosenBy.indices[next[j]++] = static_cast<Index>(i);
  }
  parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<Index> both;
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<const Index> others = chosenBy.row(i);
      both.clear();
      std::set_union(chosen[i].begin(), chosen[i].end(), others.begin(), others.end(), std::back_inserter(both));
      chosen[i].assign(both.begin(), both.end());
    }
  });
  out.neighbors = rowsOf(chosen);
  return out;
}

}  // namespace pointbased
