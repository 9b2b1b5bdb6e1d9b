// SPDX-License-Identifier: Apache-2.0
#include "forces/stiffness_factors.h"

#include "base/polar.h"
#include "forces/laminate.h"
#include "forces/point_loops.h"
#include "forces/viscous_hourglass.h"
#include "material/laws.h"

namespace pointbased::detail {
namespace {

// Square roots of the stiffness of the modes xy, xz, yz and xyz, averaged over their directions of displacement.
Eigen::Vector4d modeRoots(const HourglassEnergy &modal, const Vec3 &vs, double volume, const Vec3 &variances) {
  const double stretch = 2.0 * modal.mu() + modal.lambda();
  const double shear = modal.mu() * (kWarping + (1.0 - kWarping) / 3.0);
  const auto mean = [&](int a, int b) { return (stretch + shear) * (vs[a] + vs[b]) / 3.0; };
  return Eigen::Vector4d(mean(0, 1), mean(0, 2), mean(1, 2), modal.twist(volume, variances)).cwiseSqrt();
}

// Same for a laminate.
Eigen::Vector4d modeRoots(const ModeForm &form, double twist) {
  const double shearX = form[27], shearY = form[29], shearZ = form[32];
  return Eigen::Vector4d((form[0] + form[3] + shearX + shearY) / 3.0, (form[2] + form[6] + shearX + shearZ) / 3.0,
                         (form[5] + form[8] + shearY + shearZ) / 3.0, twist)
      .cwiseSqrt();
}

// Tangent of a point: λ (turn^T : dF) turn + μ turn dF^T turn + root² dF.
struct Elastic {
  double lambda, mu;
  Mat3 turn;
  double root;
};

Elastic elasticOf(const Material &material, double viscosity, const Mat3 &F) {
  const double mu = material.mu() + viscosity;
  const Elastic aboutRotation{material.lambda() + material.volumeStiffness, mu, Mat3::Identity(), std::sqrt(mu)};
  if (material.law == MaterialLaw::linear) return aboutRotation;
  if (material.law == MaterialLaw::neoHookean && material.lambda() >= 0.0) {
    const Mat3 c = cofactor(F);
    const double J = F.col(0).dot(c.col(0));
    if (J >= kNeoHookeanSwitch) {
      const Volumetric volume = volumetric(Moduli(material), J);
      // With stretches s it is positive if λ is positive and μ is between -root² min s² and root² s_i s_j; the product
      // of the two smallest is J over the largest.
      const double most = mu * J / std::sqrt(largestEigenvalueBound(F.transpose() * F));
      const double least = -mu * J * J / largestEigenvalueBound(c.transpose() * c);
      return {std::max(0.0, J * (J * volume.g2 + volume.g1)), std::clamp(viscosity - J * volume.g1, least, most), c / J,
              std::sqrt(mu)};
    }
  }
  Elastic turned = aboutRotation;
  turned.turn = polar(F).R;
  return turned;
}

}  // namespace

void findStiffnessFactors(const Constitution &constitution, const StencilSet &s, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor) {
  out.first.resize(s.pointCount());
  std::size_t count = 0;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    out.first[q] = count;
    count += StiffnessFactors::kNumbers * StiffnessFactors::width(s.phyxels.row(q).size());
  }
  out.numbers.assign(count, 0.0F);
  out.lambda.resize(s.pointCount());
  out.mu.resize(s.pointCount());
  const Laminates laminates = findLaminates(s, constitution);
  const bool hasModes = stabilisationOf(constitution, s) == Stabilisation::hourglass;
  runLoop(parallelFor, s.pointCount(), kPointGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const Material &material = materialOfPoint(constitution, s, q);
      const Elastic elastic = elasticOf(material, viscousScale * material.viscosity, gradients[q]);
      out.lambda[q] = static_cast<float>(elastic.lambda);
      out.mu[q] = static_cast<float>(elastic.mu);
      const double root = std::sqrt(s.volumes[q]);
      const GradientRows rows(s, q);
      const ModeRows modes(s, q);
      const Laminate *laminate = laminates.at(q);
      const Vec3 normal = laminate != nullptr ? Vec3(s.axes * laminate->normal) : Vec3(Vec3::Zero());
      const double less = laminate != nullptr ? laminate->shareOfShear() - 1.0 : 0.0;
      Eigen::Vector4d roots = Eigen::Vector4d::Zero();
      if (hasModes) {
        const HourglassEnergy elasticModes(material, constitution.stabilisation),
            viscous = viscousHourglass(material, viscousScale * constitution.stabilisation),
            modal(elasticModes.mu() + viscous.mu(), elasticModes.lambda() + viscous.lambda(),
                  elasticModes.twistModulus() + viscous.twistModulus());
        roots = laminate != nullptr
                    ? modeRoots(laminates.modes[laminates.of[q]], modal.twist(s.volumes[q], s.variances[q]))
                    : modeRoots(modal, s.volumes[q] * s.variances[q], s.volumes[q], s.variances[q]);
        if (material.law != MaterialLaw::linear) roots.head<3>() *= std::sqrt(gradients[q].squaredNorm() / 3.0);
      }
      const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
      const std::size_t width = StiffnessFactors::width(last - first);
      float *at = out.numbers.data() + out.first[q];
      for (Index e = first; e < last; ++e, ++at) {
        const Vec3 g = root * (rows[e] + less * normal.dot(rows[e]) * normal), a = elastic.turn * g,
                   b = elastic.root * g;
        for (std::size_t k = 0; k < 3; ++k) {
          at[k * width] = static_cast<float>(a[static_cast<Eigen::Index>(k)]);
          at[(3 + k) * width] = static_cast<float>(b[static_cast<Eigen::Index>(k)]);
        }
        if (!hasModes) continue;
        const Eigen::Vector4d h = roots.cwiseProduct(modes[e]);
        for (std::size_t k = 0; k < 4; ++k) at[(6 + k) * width] = static_cast<float>(h[static_cast<Eigen::Index>(k)]);
      }
    }
  });
}

}  // namespace pointbased::detail
