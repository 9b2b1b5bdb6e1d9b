// SPDX-License-Identifier: Apache-2.0
#include "law.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <stdexcept>

namespace truth {
namespace {

/// Fills the columns of the tangent with dP(dF) for the nine unit changes of F.
template <typename Differential>
void fillTangent(Mat9 &tangent, Differential differential) {
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) {
      Mat3 dF = Mat3::Zero();
      dF(k, l) = 1.0;
      const Mat3 dP = differential(dF);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) tangent(3 * i + j, 3 * k + l) = dP(i, j);
      }
    }
  }
}

StressPoint linear(const Law &law, const Mat3 &F) {
  StressPoint out;
  const auto stress = [&](const Mat3 &H) -> Mat3 {
    return law.lambda * H.trace() * Mat3::Identity() + law.mu * (H + H.transpose());
  };
  out.stress = stress(F - Mat3::Identity());
  fillTangent(out.tangent, stress);
  out.valid = true;
  return out;
}

StressPoint stvk(const Law &law, const Mat3 &F) {
  StressPoint out;
  const Mat3 E = 0.5 * (F.transpose() * F - Mat3::Identity());
  const Mat3 S = law.lambda * E.trace() * Mat3::Identity() + 2.0 * law.mu * E;
  out.stress = F * S;
  fillTangent(out.tangent, [&](const Mat3 &dF) -> Mat3 {
    const Mat3 dE2 = F.transpose() * dF + dF.transpose() * F;
    return dF * S + F * (0.5 * law.lambda * dE2.trace() * Mat3::Identity() + law.mu * dE2);
  });
  out.valid = true;
  return out;
}

StressPoint corotated(const Law &law, const Mat3 &F) {
  StressPoint out;
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 R = svd.matrixU() * svd.matrixV().transpose();
  const Mat3 S = R.transpose() * F;
  const double dilation = S.trace() - 3.0;
  out.stress = 2.0 * law.mu * (F - R) + law.lambda * dilation * R;
  // dR = R [w]x with (tr(S) I - S) w = axial(R^T dF - dF^T R).
  const Mat3 inverse = (S.trace() * Mat3::Identity() - S).inverse();
  fillTangent(out.tangent, [&](const Mat3 &dF) -> Mat3 {
    const Mat3 A = R.transpose() * dF;
    const Eigen::Vector3d w = inverse * Eigen::Vector3d(A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1));
    Mat3 spin;
    spin << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
    const Mat3 dR = R * spin;
    return 2.0 * law.mu * (dF - dR) + law.lambda * (A.trace() * R + dilation * dR);
  });
  out.valid = F.determinant() > 0.0;
  return out;
}

StressPoint neoHookean(const Law &law, const Mat3 &F, const MixedPressure *mixed) {
  StressPoint out;
  const double J = F.determinant();
  out.valid = J > 0.0;
  if (!out.valid) return out;
  const Mat3 inverse = F.inverse();
  const Mat3 G = inverse.transpose();
  const double p = mixed ? mixed->stress : law.lambda * std::log(J);
  const double tangentPressure = mixed ? mixed->tangent : p;
  const double volumeStiffness = mixed ? 0.0 : law.lambda;  // the element adds it where ln J is projected
  out.stress = law.mu * (F - G) + p * G;
  fillTangent(out.tangent, [&](const Mat3 &dF) -> Mat3 {
    return law.mu * dF + (law.mu - tangentPressure) * G * dF.transpose() * G +
           volumeStiffness * (inverse * dF).trace() * G;
  });
  return out;
}

StressPoint isochoric(const Law &law, const Mat3 &F) {
  StressPoint out;
  const double J = F.determinant();
  out.valid = J > 0.0;
  if (!out.valid) return out;
  const double kappa = law.lambda + 2.0 / 3.0 * law.mu;
  const double a = law.mu * std::pow(J, -2.0 / 3.0);
  const double I1 = F.squaredNorm();
  const Mat3 inverse = F.inverse();
  const Mat3 G = inverse.transpose();
  const Mat3 deviator = F - I1 / 3.0 * G;
  out.stress = a * deviator + kappa * (J - 1.0) * J * G;
  fillTangent(out.tangent, [&](const Mat3 &dF) -> Mat3 {
    const double t = (inverse * dF).trace();
    const Mat3 dG = -G * dF.transpose() * G;
    const double dI1 = 2.0 * F.cwiseProduct(dF).sum();
    return -2.0 / 3.0 * a * t * deviator + a * (dF - dI1 / 3.0 * G - I1 / 3.0 * dG) +
           kappa * ((2.0 * J - 1.0) * J * t * G + (J - 1.0) * J * dG);
  });
  return out;
}

}  // namespace

Law makeLaw(const std::string &name, double youngsModulus, double poissonRatio, double density) {
  Law law;
  if (name == "linear")
    law.kind = LawKind::linear;
  else if (name == "stvk")
    law.kind = LawKind::stvk;
  else if (name == "corotated")
    law.kind = LawKind::corotated;
  else if (name == "neo_hookean")
    law.kind = LawKind::neoHookean;
  else if (name == "neo_hookean_mixed")
    law.kind = LawKind::neoHookeanMixed;
  else if (name == "isochoric")
    law.kind = LawKind::isochoric;
  else
    throw std::runtime_error("unknown law: " + name);
  law.lambda = youngsModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio));
  law.mu = youngsModulus / (2.0 * (1.0 + poissonRatio));
  law.density = density;
  return law;
}

StressPoint evaluate(const Law &law, const Mat3 &F, const MixedPressure &pressure) {
  switch (law.kind) {
    case LawKind::linear: return linear(law, F);
    case LawKind::stvk: return stvk(law, F);
    case LawKind::corotated: return corotated(law, F);
    case LawKind::neoHookean: return neoHookean(law, F, nullptr);
    case LawKind::neoHookeanMixed: return neoHookean(law, F, &pressure);
    case LawKind::isochoric: return isochoric(law, F);
  }
  return {};
}

}  // namespace truth
