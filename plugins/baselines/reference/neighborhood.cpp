// SPDX-License-Identifier: Apache-2.0
#include "reference/neighborhood.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reference {

double poly6(double r, double h) {
  if (r >= h) return 0.0;
  const double s = h * h - r * r;
  return 315.0 / (64.0 * EIGEN_PI * std::pow(h, 9)) * s * s * s;
}

Neighborhoods nearestNeighbors(std::span<const Vec3> positions, std::size_t count, const Errata &errata) {
  Neighborhoods out;
  std::vector<std::pair<double, std::size_t>> byDistance;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    byDistance.clear();
    for (std::size_t j = 0; j < positions.size(); ++j)
      if (j != i) byDistance.emplace_back((positions[j] - positions[i]).norm(), j);
    auto last = byDistance.begin() + static_cast<std::ptrdiff_t>(count);
    std::nth_element(byDistance.begin(), last - 1, byDistance.end());
    const double farthest = (last - 1)->first;
    double h = farthest;
    if (!errata.vanishingShell) {
      last = std::partition(last, byDistance.end(), [&](const auto &c) { return c.first <= farthest * (1.0 + 1e-9); });
      h = kSupportMargin * farthest;
    }
    std::sort(byDistance.begin(), last);

    double sum = 0.0;
    for (auto chosen = byDistance.begin(); chosen != last; ++chosen) {
      const auto [r, j] = *chosen;
      out.neighbors.push_back(j);
      out.weights.push_back(poly6(r, h));
      sum += r;
    }
    out.first.push_back(out.neighbors.size());
    out.selfWeights.push_back(poly6(0.0, h));
    out.supportRadii.push_back(h);
    out.meanDistances.push_back(sum / static_cast<double>(last - byDistance.begin()));
  }
  return out;
}

std::size_t effectiveNeighbors(const Neighborhoods &n, std::size_t i) {
  std::size_t count = 0;
  for (std::size_t k = n.first[i]; k < n.first[i + 1]; ++k)
    if (n.weights[k] > 1e-12 * poly6(0.0, n.supportRadii[i])) ++count;
  return count;
}

}  // namespace reference
