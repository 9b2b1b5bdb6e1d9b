// SPDX-License-Identifier: Apache-2.0
#include "pointbased/plasticity.h"

#include <Eigen/LU>
#include <cmath>

#include "base/symmetric_eigen.h"
#include "material/laws.h"

namespace pointbased {

using namespace detail;
namespace {

Vec3 halfLog(const Vec3 &squaredStretches) { return 0.5 * squaredStretches.array().log().matrix(); }
Vec3 deviator(const Vec3 &h) { return h.array() - h.mean(); }

// Fp^-1 with the logarithm of its stretch scaled by `factor`; its rotation does not affect the stress and is preserved.
Mat3 scaledInLogarithm(const SymmetricEigen &eigen, const Vec3 &hencky, double factor, const Mat3 &plasticInverse) {
  const Vec3 change = ((factor - 1.0) * hencky).array().exp();
  return eigen.with(change) * plasticInverse;
}

}  // namespace

Mat3 henckyStrain(const Mat3 &F) {
  if (!(F.determinant() > 0.0)) return Mat3::Constant(std::nan(""));
  const SymmetricEigen eigen = symmetricEigen(F.transpose() * F);
  return eigen.with(halfLog(eigen.values));
}

double deviatoricHenckyNorm(const Mat3 &F) {
  if (!(F.determinant() > 0.0)) return std::nan("");
  return deviator(halfLog(symmetricEigenvalues(F.transpose() * F))).norm();
}

double flowShare(const Plasticity &plastic, double dt) {
  return plastic.creep >= 1.0 ? 1.0 : -std::expm1(dt / plastic.creepTime * std::log1p(-plastic.creep));
}

bool plasticFlow(const Plasticity &plastic, const Mat3 &F, double dt, Mat3 &plasticInverse, FlowResult *result,
                 const Mat3 *before) {
  if (result) *result = FlowResult();
  if (!plastic.enabled() || !(dt > 0.0) || !(F.determinant() > kSmallestFlowRatio)) return false;
  const Mat3 Fe = F * plasticInverse;
  const Mat3 C = Fe.transpose() * Fe;
  // |ln C|/2 <= -ln(1 - 2 |E|)/2, which is below yield for |E| <= yield/(1 + 2 yield): most points need no eigenvalues.
  const double strain = 0.5 * (C - Mat3::Identity()).norm();
  if (strain * (1.0 + 2.0 * plastic.yield) <= plastic.yield || !std::isfinite(strain)) return false;

  const SymmetricEigen eigen = symmetricEigen(C);
  if (!(eigen.values[0] > 0.0)) return false;
  const Vec3 h = deviator(halfLog(eigen.values));
  const double norm = h.norm();
  const double excess = norm - plastic.yield;
  if (!(excess > 0.0)) return false;
  const double flow = flowShare(plastic, dt) * excess;

  const Vec3 change = (-flow / norm * h).array().exp();
  Mat3 next = plasticInverse * eigen.vectors * change.asDiagonal() * eigen.vectors.transpose();
  next /= std::cbrt(next.determinant());
  bool capped = false;
  double plasticStrain = 0.0;
  if (plastic.max < Plasticity::kNever || result) {
    const Mat3 all = before ? Mat3(*before * next) : next;
    const SymmetricEigen ofPlastic = symmetricEigen(all * all.transpose());
    const Vec3 hencky = deviator(halfLog(ofPlastic.values));
    plasticStrain = hencky.norm();
    if (plasticStrain > plastic.max) {
      next = scaledInLogarithm(ofPlastic, hencky, plastic.max / plasticStrain, all);
      if (before) next = before->inverse() * next;
      next /= std::cbrt(next.determinant());
      plasticStrain = plastic.max;
      capped = true;
    }
  }
  if (!next.allFinite()) return false;
  plasticInverse = next;
  if (result) *result = {capped ? deviatoricHenckyNorm(F * next) : norm - flow, plasticStrain, flow, capped};
  return true;
}

Mat3 elastoplasticStress(const Material &material, const Mat3 &F, const Mat3 &plasticInverse) {
  return firstPiolaStress(material, F * plasticInverse) * plasticInverse.transpose();
}

double elastoplasticEnergyDensity(const Material &material, const Mat3 &F, const Mat3 &plasticInverse) {
  return energyDensity(material, F * plasticInverse);
}

Mat3 elastoplasticStressDifferential(const Material &material, const Mat3 &F, const Mat3 &plasticInverse,
                                     const Mat3 &dF) {
  return stressDifferential(material, F * plasticInverse, dF * plasticInverse) * plasticInverse.transpose();
}

double elastoplasticTangentRatio(const Material &material, const Mat3 &F, const Mat3 &plasticInverse) {
  const double stretch2 = detail::largestEigenvalueBound(plasticInverse * plasticInverse.transpose());
  return stretch2 * tangentRatio(material, F * plasticInverse);
}

}  // namespace pointbased
