// SPDX-License-Identifier: Apache-2.0
// Determines which points of a regular grid are on the same side of a surface. Private to the core.
#pragma once

#include <algorithm>
#include <array>

#include "pointbased/types.h"

namespace pointbased::detail {

/// Two neighbours whose distances from the surface sum to more than the distance between them are on the same side. One
/// query per group of such points decides, at its deepest point.
class GridSides {
 public:
  /// @param n          points along each axis, x fastest
  /// @param distances  [points] >= 0; no more than the true ones
  /// @param look       called for every point
  template <class Look>
  void find(const std::array<std::size_t, 3> &n, double step, std::span<const double> distances, Look &&look) {
    constexpr Index kNone = 0xffffffffu;
    const double reach = 1.001 * step;
    groups_.assign(distances.size(), kNone);
    deepest_.clear();
    for (std::size_t seed = 0; seed < distances.size(); ++seed) {
      if (groups_[seed] != kNone) continue;
      const auto group = static_cast<Index>(deepest_.size());
      std::size_t deepest = seed;
      groups_[seed] = group;
      open_.assign(1, seed);
      while (!open_.empty()) {
        const std::size_t i = open_.back();
        open_.pop_back();
        look();
        if (distances[i] > distances[deepest]) deepest = i;
        const auto visit = [&](std::size_t j) {
          if (groups_[j] != kNone || distances[i] + distances[j] <= reach) return;
          groups_[j] = group;
          open_.push_back(j);
        };
        std::size_t along = i, stride = 1;
        for (const std::size_t count : n) {
          const std::size_t at = along % count;
          if (at > 0) visit(i - stride);
          if (at + 1 < count) visit(i + stride);
          along /= count;
          stride *= count;
        }
      }
      deepest_.push_back(deepest);
    }
  }
  void find(const std::array<std::size_t, 3> &n, double step, std::span<const double> distances) {
    find(n, step, distances, [] {});
  }

  [[nodiscard]] std::span<const Index> groups() const { return groups_; }  ///< [points]
  /// [groups] points to query
  [[nodiscard]] std::span<const std::size_t> deepest() const { return deepest_; }

 private:
  std::vector<Index> groups_;
  std::vector<std::size_t> deepest_, open_;
};

}  // namespace pointbased::detail
