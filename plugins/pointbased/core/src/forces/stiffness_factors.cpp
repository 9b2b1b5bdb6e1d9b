// SPDX-License-Identifier: Apache-2.0
#include "forces/stiffness_factors.h"

#include "base/polar.h"
#include "forces/hourglass_energy.h"
#include "forces/point_loops.h"

namespace pointbased::detail {
namespace {

// Roots of the stiffness of the modes xy, xz, yz and xyz, means over the directions they may move in.
Eigen::Vector4d modeRoots(const HourglassEnergy &modal, const Vec3 &vs, double volume, const Vec3 &variances) {
  const double stretch = 2.0 * modal.mu() + modal.lambda();
  const double shear = modal.mu() * (kWarping + (1.0 - kWarping) / 3.0);
  const auto mean = [&](int a, int b) { return (stretch + shear) * (vs[a] + vs[b]) / 3.0; };
  return Eigen::Vector4d(mean(0, 1), mean(0, 2), mean(1, 2), modal.twist(volume, variances)).cwiseSqrt();
}

}  // namespace

void findStiffnessFactors(const Constitution &constitution, const StencilSet &s, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor) {
  out.gradients.resize(s.phyxels.indices.size());
  out.modes.resize(s.phyxels.indices.size());
  out.lambda.resize(s.pointCount());
  out.mu.resize(s.pointCount());
  const bool hasModes = stabilisationOf(constitution, s) == Stabilisation::hourglass;
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Material &material = materialOfPoint(constitution, s, q);
      out.lambda[q] = static_cast<float>(material.lambda() + material.volumeStiffness);
      out.mu[q] = static_cast<float>(material.mu() + viscousScale * material.viscosity);
      const Mat3 R = material.law == MaterialLaw::linear ? Mat3(Mat3::Identity()) : polar(gradients[q]).R;
      const Mat3 turn = std::sqrt(s.volumes[q]) * R;
      const GradientRows rows(s, q);
      const ModeRows modes(s, q);
      Eigen::Vector4d roots = Eigen::Vector4d::Zero();
      if (hasModes) {
        const HourglassEnergy modal(material, constitution.stabilisation);
        roots = modeRoots(modal, s.volumes[q] * s.variances[q], s.volumes[q], s.variances[q]);
      }
      for (Index e = s.phyxels.offsets[q]; e < s.phyxels.offsets[q + 1]; ++e) {
        out.gradients[e] = (turn * rows[e]).cast<float>();
        out.modes[e] = hasModes ? roots.cwiseProduct(modes[e]).cast<float>().eval() : Eigen::Vector4f::Zero().eval();
      }
    }
  });
}

}  // namespace pointbased::detail
