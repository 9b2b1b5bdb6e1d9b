// SPDX-License-Identifier: Apache-2.0
#include "forces/stiffness_factors.h"

#include <Eigen/Eigenvalues>

#include "base/polar.h"
#include "forces/laminate.h"
#include "forces/point_loops.h"
#include "forces/quadratic_energy.h"
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

// b of the entries of a point, of which the first is at `at`.
void findStrainGradients(const StencilSet &s, std::size_t q, const QuadraticPoints::Point &point, const Mat3 &F,
                         bool isLinear, const ModeRows &modes, float *at, std::size_t width) {
  const Eigen::SelfAdjointEigenSolver<Mat3> covariance(s.volumes[q] * point.covariance);
  const Mat3 roots = covariance.eigenvectors() * covariance.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Mat3 turn = isLinear ? s.axes : Mat3(std::sqrt(F.squaredNorm() / 3.0) * polar(F).R * s.axes);
  const Index first = s.phyxels.offsets[q], last = s.phyxels.offsets[q + 1];
  const Vec3 *bends = s.quadratic.bends.data() + point.first;
  for (Index e = first; e < last; ++e, ++bends, ++at) {
    const Eigen::Vector4d &mixed = modes[e];
    Mat3 second;
    second << (*bends)[0], mixed[0], mixed[1], mixed[0], (*bends)[1], mixed[2], mixed[1], mixed[2], (*bends)[2];
    const Mat3 b = turn * second * roots;
    for (std::size_t k = 0; k < StiffnessFactors::kStrainGradientNumbers; ++k)
      at[k * width] = static_cast<float>(b.data()[k]);
  }
}

}  // namespace

void findStiffnessFactors(const Constitution &constitution, const StencilSet &s, std::span<const Mat3> gradients,
                          double viscousScale, StiffnessFactors &out, const ParallelFor &parallelFor) {
  out.first.resize(s.pointCount());
  std::size_t count = 0;
  for (std::size_t q = 0; q < s.pointCount(); ++q) {
    out.first[q] = count;
    const std::size_t numbers =
        StiffnessFactors::kNumbers + (s.quadratic.find(q) != nullptr ? StiffnessFactors::kStrainGradientNumbers : 0);
    count += numbers * StiffnessFactors::width(s.phyxels.row(q).size());
  }
  out.numbers.assign(count, 0.0F);
  out.lambda.resize(s.pointCount());
  out.mu.resize(s.pointCount());
  out.strainGradientLambda.assign(s.quadratic.of.empty() ? 0 : s.pointCount(), 0.0F);
  out.strainGradientMu.assign(out.strainGradientLambda.size(), 0.0F);
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
      const QuadraticPoints::Point *second = hasModes && !material.relaxes() ? s.quadratic.find(q) : nullptr;
      if (hasModes) {
        const HourglassEnergy elasticModes(material, constitution.stabilisation),
            viscous = viscousHourglass(material, viscousScale * constitution.stabilisation),
            modal(elasticModes.mu() + viscous.mu(), elasticModes.lambda() + viscous.lambda(),
                  elasticModes.twistModulus() + viscous.twistModulus());
        roots = laminate != nullptr
                    ? modeRoots(laminates.modes[laminates.of[q]], modal.twist(s.volumes[q], s.variances[q]))
                    : modeRoots(modal, s.volumes[q] * s.variances[q], s.volumes[q], s.variances[q]);
        if (material.law != MaterialLaw::linear) roots.head<3>() *= std::sqrt(gradients[q].squaredNorm() / 3.0);
        if (second != nullptr) {
          roots.head<3>().setZero();
          out.strainGradientLambda[q] = static_cast<float>(modal.lambda() / kLatticeStabilisation);
          out.strainGradientMu[q] = static_cast<float>(modal.mu() / kLatticeStabilisation);
        }
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
      if (second != nullptr)
        findStrainGradients(s, q, *second, gradients[q], material.law == MaterialLaw::linear, modes,
                            out.numbers.data() + out.first[q] + StiffnessFactors::kNumbers * width, width);
    }
  });
}

}  // namespace pointbased::detail
