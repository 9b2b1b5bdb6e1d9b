// SPDX-License-Identifier: Apache-2.0
#include "vector_forces.h"

#include "vector_forces_parts.h"

namespace pointbased::detail {

double strayAnswer(const void *context, std::size_t material, const double *F, double *stress) {
  const auto &constitution = *static_cast<const Constitution *>(context);
  const Mat3 gradient = Eigen::Map<const Mat3>(F);
  const Material &m = constitution.materials[material];
  Eigen::Map<Mat3> answer(stress);
  answer = firstPiolaStress(m, gradient);
  return tangentRatio(m, gradient);
}

OtherPoints::OtherPoints(const StencilSet &stencils, std::span<const Vec3> positions, const Constitution &constitution,
                         std::span<const Index> points)
    : stencils_(stencils), positions_(positions), constitution_(constitution) {
  if (points.empty()) return;
  for (const Index q : points) {
    if (!runs_.empty() && runs_.back().second == q && q - runs_.back().first < kPointGrain) {
      ++runs_.back().second;
    } else {
      runs_.emplace_back(q, q + 1);
    }
    for (Index e = stencils.phyxels.offsets[q]; e < stencils.phyxels.offsets[q + 1]; ++e) entries_.push_back(e);
  }
  entryForces_.resize(stencils.phyxels.indices.size());
  gradients_.resize(stencils.pointCount());
  stresses_.resize(stencils.pointCount());
  ratios_.assign(stencils.pointCount(), 1.0);
}

double OtherPoints::evaluate(std::span<const Vec3> u, const ParallelFor &parallelFor) {
  const ParallelFor loop = [this, &parallelFor](std::size_t, std::size_t,
                                                const std::function<void(std::size_t, std::size_t)> &body) {
    const auto some = [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) body(runs_[r].first, runs_[r].second);
    };
    parallelFor(runs_.size(), 1, std::cref(some));
  };
  deformationGradients(stencils_, u, gradients_, loop);
  const double ratio = pointStresses(constitution_, stencils_, gradients_, {}, PointHistory(), 0.0, nullptr, stresses_,
                                     ratios_, loop);
  entryForcesOf(constitution_, stencils_, positions_, u, gradients_, stresses_, {}, entryForces_, loop);
  return ratio;
}

std::size_t OtherPoints::memory() const {
  return bytesOf(runs_) + bytesOf(entries_) + bytesOf(entryForces_) + bytesOf(gradients_) + bytesOf(stresses_) +
         bytesOf(ratios_);
}

std::unique_ptr<VectorForces> vectorForces(const StencilSet &stencils, std::span<const Vec3> positions,
                                           const Constitution &constitution, Precision precision) {
  if (positions.empty() || !stencils.reference.empty()) return nullptr;
  // The kernels know the answer to the present strain alone.
  for (const Material &m : constitution.materials)
    if (m.relaxes() || m.plastic.enabled() || m.viscosity > 0.0) return nullptr;
  return stencils.modes.empty() ? cloudForcesOf(stencils, positions, constitution, precision)
                                : cellForcesOf(stencils, positions, constitution, precision);
}

}  // namespace pointbased::detail
