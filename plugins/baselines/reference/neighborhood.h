// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "reference/errata.h"

namespace reference {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// w(r, h) = 315/(64 pi h⁹) (h² - r²)³ for r < h, else 0; 1/m³.
/// @source  Müller et al. 2003, poly6; Müller et al. 2004
[[nodiscard]] double poly6(double r, double h);

/// The neighbours of phyxel i are neighbors[k], their weights weights[k], for k in [first[i], first[i + 1]).
struct Neighborhoods {
  std::vector<std::size_t> first{0};
  std::vector<std::size_t> neighbors;  ///< by distance, without i itself
  std::vector<double> weights;         ///< w_ij = poly6(|X_j - X_i|, h_i), 1/m³
  std::vector<double> selfWeights;     ///< [phyxels] w_ii, for the density
  std::vector<double> supportRadii;    ///< [phyxels] h_i, m
  std::vector<double> meanDistances;   ///< [phyxels] d_i, mean distance of the neighbours, m
};

/// The N nearest phyxels of every phyxel, by trying all.
///
/// vanishingShell: h is the distance of the N-th, and exactly N are chosen. Otherwise those as far as the N-th come in
/// as well and h is kSupportMargin times that distance.
/// @pre     0 < count < positions.size()
/// @source  thesis, N nearest; Müller et al. 2004, 3.2
[[nodiscard]] Neighborhoods nearestNeighbors(std::span<const Vec3> positions, std::size_t count, const Errata &errata);

inline constexpr double kSupportMargin = 1.1;

/// How many neighbours of i have a weight that is not zero but for rounding.
[[nodiscard]] std::size_t effectiveNeighbors(const Neighborhoods &neighborhoods, std::size_t i);

}  // namespace reference
