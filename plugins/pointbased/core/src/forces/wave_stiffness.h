// SPDX-License-Identifier: Apache-2.0
// Stiffness around phyxels against the fastest wave. Private to the core.
#pragma once

#include <vector>

#include "base/cancellation_poll.h"
#include "forces/point_loops.h"

namespace pointbased::detail {

/// Σ_q v (λ + 2 μ) |g_qi|² of the phyxels at rest, N/m; divided by the masses, approximately the square of the local
/// frequencies.
/// @param isByCorners  for a point whose cell has hanging corners: |g|² of the corners, distributed by their weights,
///                     and for one of second order: |g|² of the trilinear functions of its corners, as in the kernels;
///                     otherwise from the rows of its stencil
template <class IsByCorners>
[[nodiscard]] std::vector<double> waveStiffnesses(const Constitution &constitution, const StencilSet &s,
                                                  std::size_t phyxels, const ParallelFor &parallelFor,
                                                  const IsByCorners &isByCorners) {
  std::vector<double> sums(phyxels, 0.0);
  CancellationPoll look(parallelFor);
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    look();
    const double stiffness = s.volumes[q] * materialOfPoint(constitution, s, q).waveModulus();
    if (const HangingCells::Point *point = s.hanging.find(q); point != nullptr && isByCorners(q)) {
      std::array<Vec3, 8> gradients;
      cellGradients(point->shape, s.axes, gradients);
      for (std::size_t j = 0; j < gradients.size(); ++j) {
        const double ofCorner = stiffness * gradients[j].squaredNorm();
        s.hanging.visit(point->corners[j], [&](Index phyxel, double weight) { sums[phyxel] += weight * ofCorner; });
      }
      continue;
    }
    if (const QuadraticPoints::Point *point = s.quadratic.find(q); point != nullptr && isByCorners(q)) {
      std::array<Vec3, 8> gradients;
      cellGradients(point->corners, s.axes, gradients);
      for (std::size_t j = 0; j < gradients.size(); ++j)
        sums[s.phyxels.row(q)[j]] += stiffness * gradients[j].squaredNorm();
      continue;
    }
    const GradientRows gradients(s, q);
    for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e)
      sums[s.phyxels.indices[e]] += stiffness * gradients[e].squaredNorm();
  }
  return sums;
}

}  // namespace pointbased::detail
