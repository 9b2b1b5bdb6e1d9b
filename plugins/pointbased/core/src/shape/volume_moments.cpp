// SPDX-License-Identifier: Apache-2.0
#include "shape/volume_moments.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <map>

namespace pointbased::detail {

Vec3 VolumeMoments::boxEdges() const {
  const Mat3 central = second / volume - first * first.transpose() / (volume * volume);
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(central, Eigen::EigenvaluesOnly);
  return (12.0 * eigen.eigenvalues()).cwiseMax(0.0).cwiseSqrt();
}

VolumeMoments momentsOfLargestPart(const Surface &surface) {
  std::vector<std::size_t> parent(surface.positions.size());
  const auto rootOf = [&](std::size_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  std::map<std::array<double, 3>, std::size_t> firstAt;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    const Vec3 &x = surface.positions[i];
    parent[i] = firstAt.try_emplace({x[0], x[1], x[2]}, i).first->second;
  }
  for (const auto &t : surface.triangles) {
    parent[rootOf(t[1])] = rootOf(t[0]);
    parent[rootOf(t[2])] = rootOf(t[0]);
  }
  std::map<std::size_t, VolumeMoments> parts;
  for (const auto &t : surface.triangles) {
    // The tetrahedron from the first vertex, with the sign of its orientation.
    Mat3 corners;
    for (int i = 0; i < 3; ++i)
      corners.col(i) = surface.positions[t[static_cast<std::size_t>(i)]] - surface.positions.front();
    const double volume = corners.determinant() / 6.0;
    const Vec3 sum = corners.rowwise().sum();
    VolumeMoments &part = parts[rootOf(t[0])];
    part.volume += volume;
    part.first += volume / 4.0 * sum;
    part.second += volume / 20.0 * (corners * corners.transpose() + sum * sum.transpose());
  }
  return std::max_element(parts.begin(), parts.end(),
                          [](const auto &a, const auto &b) { return a.second.volume < b.second.volume; })
      ->second;
}

}  // namespace pointbased::detail
