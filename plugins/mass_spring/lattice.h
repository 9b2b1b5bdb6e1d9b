// SPDX-License-Identifier: Apache-2.0
// The cubic lattice that fills a surface, and the surface in it. At rest; lengths in m.
#pragma once

#include <functional>

#include "vectors.h"

namespace mass_spring {

/// Closed, outwards by the right-hand rule.
struct Surface {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Vec3 min{}, max{};
  double volume_m3 = 0.0;
};

/// A point by others, as by the eight corners of a cell; weights add up to 1, and are negative beside the cell.
struct Bound {
  std::vector<std::uint32_t> nodes;
  std::vector<double> weights;
  [[nodiscard]] Vec3 of(const std::vector<Vec3> &values) const {
    Vec3 sum{};
    for (std::size_t a = 0; a < nodes.size(); ++a) sum += weights[a] * values[nodes[a]];
    return sum;
  }
};

/// @param points  @return inside (above 1/2) or not, one per point
using Inside = std::function<std::vector<double>(const std::vector<Vec3> &points)>;

class Lattice {
 public:
  struct Cell {
    std::array<std::uint32_t, 8> nodes{};  ///< x fastest
    Vec3 low{};                            ///< its lower corner
    double filled = 0.0;                   ///< part of it that lies in the body, above 0
  };

  /// @throws sdk::Error  too many cells, or none; cancelled
  Lattice(const Surface &surface, double spacing_m, const Inside &inside, const sdk::Progress &progress);

  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] const std::vector<Vec3> &nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<Cell> &cells() const { return cells_; }
  [[nodiscard]] Vec3 centre(const Cell &cell) const {
    return cell.low + Vec3{0.5 * spacing_, 0.5 * spacing_, 0.5 * spacing_};
  }
  /// In the nearest cell. @param off  how far outside of it the point lies, m
  [[nodiscard]] Bound bind(const Vec3 &point, double *off = nullptr) const;

 private:
  [[nodiscard]] double distance(const Cell &cell, const Vec3 &point) const;

  double spacing_;
  Vec3 origin_{};
  std::array<std::int64_t, 3> counts_{};
  std::vector<std::int32_t> cellAt_;  // -1: none
  std::vector<Cell> cells_;
  std::vector<Vec3> nodes_;
};

/// The same surface with edges of at most `longest`, where that does not make it huge.
[[nodiscard]] Surface refined(Surface surface, double longest_m);

}  // namespace mass_spring
