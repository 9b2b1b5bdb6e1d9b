// SPDX-License-Identifier: Apache-2.0
#include "pointbased/engine.h"

#include "base/expects.h"
#include "discretisation/rank_deficient_gradient.h"
#include "forces/point_loops.h"

namespace pointbased {

using namespace detail;

namespace {

Mat3 fittedGradient(const StencilSet &s, std::size_t q, std::span<const Vec3> field) {
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Vec3 anchor = field[s.phyxels.indices[first]];
  const GradientRows gradients(s, q);
  Mat3 G = Mat3::Zero();
  for (Index e = first + 1; e < last; ++e) G += (field[s.phyxels.indices[e]] - anchor) * gradients[e].transpose();
  return G;
}

}  // namespace

void deformationGradients(const StencilSet &s, std::span<const Vec3> displacements, std::span<Mat3> gradients,
                          const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(displacements.size() == s.entriesOfPhyxel.rows(), "one displacement per phyxel");
  POINTBASED_EXPECTS(gradients.size() == s.pointCount(), "one gradient per evaluation point");
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      Mat3 F = fittedGradient(s, q, displacements) + (s.reference.empty() ? Mat3(Mat3::Identity()) : s.reference[q]);
      if (s.rank[q] < 3) F = completed(F, s.rank[q], frameOfPoint(s, q));
      gradients[q] = F;
    }
  });
}

void gradientRates(const StencilSet &s, std::span<const Vec3> velocities, std::span<Mat3> rates,
                   const ParallelFor &parallelFor) {
  POINTBASED_EXPECTS(velocities.size() == s.entriesOfPhyxel.rows(), "one velocity per phyxel");
  POINTBASED_EXPECTS(rates.size() == s.pointCount(), "one rate per evaluation point");
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) rates[q] = fittedGradient(s, q, velocities);
  });
}

}  // namespace pointbased
