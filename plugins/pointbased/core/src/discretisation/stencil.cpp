// SPDX-License-Identifier: Apache-2.0
#include "pointbased/stencil.h"

#include <algorithm>

#include "discretisation/moment.h"

namespace pointbased {

StencilSet buildPhyxelStencils(std::span<const Vec3> positions, const Csr &neighbors,
                               std::span<const double> supportRadii, std::span<const double> volumes,
                               const ParallelFor &parallelFor) {
  const std::size_t n = positions.size();
  StencilSet s;
  s.volumes.assign(volumes.begin(), volumes.end());
  s.rank.assign(n, 3);
  s.frameOf.assign(n, StencilSet::kNoFrame);
  s.phyxels.offsets.resize(n + 1);
  for (std::size_t i = 0; i <= n; ++i) s.phyxels.offsets[i] = neighbors.offsets[i] + static_cast<Index>(i);
  const std::size_t entries = s.phyxels.offsets[n];
  s.phyxels.indices.resize(entries);
  s.gradients.resize(entries);
  s.weights.resize(entries);
  s.weightFactors.assign(n, 1.0);
  std::vector<Mat3> frames(n);

  parallelFor(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = s.phyxels.offsets[i];
      s.phyxels.indices[first] = static_cast<Index>(i);

      Mat3 A = Mat3::Zero();
      double spread = 0.0;
      std::size_t e = first + 1;
      for (Index k = neighbors.offsets[i]; k < neighbors.offsets[i + 1]; ++k, ++e) {
        const Index j = neighbors.indices[k];
        const Vec3 d = positions[j] - positions[i];
        const double w = kernelWeight(d.norm(), std::max(supportRadii[i], supportRadii[j]));
        s.phyxels.indices[e] = j;
        s.weights[e] = w;
        A += w * d * d.transpose();
        spread += w * d.squaredNorm();
      }

      if (spread > 0.0) s.weightFactors[i] = 3.0 / spread;
      const detail::MomentInverse moment = detail::invertMoment(A);
      Vec3 sum = Vec3::Zero();
      e = first + 1;
      for (Index k = neighbors.offsets[i]; k < neighbors.offsets[i + 1]; ++k, ++e) {
        const Vec3 d = positions[neighbors.indices[k]] - positions[i];
        s.gradients[e] = s.weights[e] * (moment.inverse * d);
        sum += s.gradients[e];
        s.weights[e] *= s.weightFactors[i];
      }
      s.gradients[first] = -sum;
      s.weights[first] = 0.0;
      s.rank[i] = static_cast<std::uint8_t>(moment.rank);
      frames[i] = moment.frame;
    }
  });

  for (std::size_t i = 0; i < n; ++i)
    if (s.rank[i] < 3) {
      s.frameOf[i] = static_cast<Index>(s.frames.size());
      s.frames.push_back(frames[i]);
    }
  buildGather(s, n);
  return s;
}

void buildGather(StencilSet &s, std::size_t phyxelCount) {
  const std::size_t entries = s.phyxels.indices.size();
  s.entriesOfPhyxel.offsets.assign(phyxelCount + 1, 0);
  for (const Index j : s.phyxels.indices) ++s.entriesOfPhyxel.offsets[j + 1];
  for (std::size_t j = 0; j < phyxelCount; ++j) s.entriesOfPhyxel.offsets[j + 1] += s.entriesOfPhyxel.offsets[j];
  s.entriesOfPhyxel.indices.resize(entries);
  std::vector<Index> next(s.entriesOfPhyxel.offsets.begin(), s.entriesOfPhyxel.offsets.end() - 1);
  for (std::size_t q = 0; q < s.pointCount(); ++q)
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
      s.entriesOfPhyxel.indices[next[s.phyxels.indices[e]]++] = e;
}

}  // namespace pointbased
