// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surfels.h"

#include <algorithm>
#include <cmath>

#include "point_tree.h"

namespace pointbased {

SurfelBinding bindSurfels(std::span<const Vec3> positions, std::span<const Vec3> normals,
                          std::span<const Vec3> phyxelPositions, const ParallelFor &parallelFor) {
  SurfelBinding binding;
  binding.positions.assign(positions.begin(), positions.end());
  binding.normals.assign(normals.begin(), normals.end());
  const std::size_t n = positions.size();
  const std::size_t k = std::min(kPhyxelsPerSurfel, phyxelPositions.size());
  binding.phyxels.offsets.resize(n + 1);
  for (std::size_t s = 0; s <= n; ++s) binding.phyxels.offsets[s] = static_cast<Index>(s * k);
  binding.phyxels.indices.resize(n * k);
  binding.weights.resize(n * k);
  if (k == 0) return binding;

  const PointTree tree(phyxelPositions);
  parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared(k);
    for (std::size_t s = begin; s < end; ++s) {
      Index *indices = &binding.phyxels.indices[s * k];
      double *weights = &binding.weights[s * k];
      tree.nearest(positions[s], k, indices, squared.data());
      const double support = 1.1 * std::sqrt(squared[k - 1]);
      double sum = 0.0;
      for (std::size_t e = 0; e < k; ++e) {
        weights[e] = support > 0.0 ? kernelWeight(std::sqrt(squared[e]), support) : 1.0;
        sum += weights[e];
      }
      for (std::size_t e = 0; e < k; ++e) weights[e] = sum > 0.0 ? weights[e] / sum : 1.0 / static_cast<double>(k);
    }
  });
  return binding;
}

void updateSurfels(const SurfelBinding &binding, std::span<const Vec3> X, std::span<const Vec3> u,
                   std::span<const Mat3> gradients, std::span<Vec3> positions, std::span<Vec3> normals,
                   const ParallelFor &parallelFor) {
  const bool withNormals = !normals.empty();
  parallelFor(binding.count(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec3 rest = binding.positions[s];
      Vec3 x = Vec3::Zero();
      Mat3 F = Mat3::Zero();
      for (Index e = binding.phyxels.offsets[s]; e < binding.phyxels.offsets[s + 1]; ++e) {
        const Index j = binding.phyxels.indices[e];
        const double w = binding.weights[e];
        const Vec3 d = rest - X[j];
        x += w * (u[j] + gradients[j] * d - d);
        if (withNormals) F += w * gradients[j];
      }
      positions[s] = rest + x;
      if (!withNormals) continue;
      Mat3 cofactor;
      cofactor.col(0) = F.col(1).cross(F.col(2));
      cofactor.col(1) = F.col(2).cross(F.col(0));
      cofactor.col(2) = F.col(0).cross(F.col(1));
      const Vec3 n = cofactor * binding.normals[s];
      const double length = n.norm();
      normals[s] = length > 0.0 ? Vec3(n / length) : binding.normals[s];
    }
  });
}

}  // namespace pointbased
