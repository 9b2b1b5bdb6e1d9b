// SPDX-License-Identifier: Apache-2.0
#include "pointbased/material.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pointbased {
namespace {

Mat3 cofactor(const Mat3 &F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

// The volumetric part g(J) = -mu ln J + lambda/2 (ln J)^2 of the neo-Hookean energy and its derivatives.
struct Volumetric {
  double g, g1, g2;
};

Volumetric logVolumetric(double lambda, double mu, double J) {
  const double l = std::log(J);
  return {-mu * l + 0.5 * lambda * l * l, (lambda * l - mu) / J, (lambda + mu - lambda * l) / (J * J)};
}

Volumetric volumetric(double lambda, double mu, double J) {
  if (J >= kNeoHookeanSwitch) return logVolumetric(lambda, mu, J);
  const Volumetric at = logVolumetric(lambda, mu, kNeoHookeanSwitch);
  const double d = J - kNeoHookeanSwitch;
  return {at.g + at.g1 * d + 0.5 * at.g2 * d * d, at.g1 + at.g2 * d, at.g2};
}

// Largest eigenvalue of a symmetric positive matrix from its first two moments; exact when the other two are equal.
double largestEigenvalueBound(const Mat3 &m) {
  const double t = m.trace() / 3.0;
  const double variance = std::max(0.0, m.squaredNorm() - 3.0 * t * t);
  return t + std::sqrt(2.0 / 3.0 * variance);
}

}  // namespace

Result<void> validate(const Material &m) {
  std::string text;
  const auto need = [&](bool ok, const char *name, double value, const char *accepted) {
    if (ok) return;
    char shown[40];
    std::snprintf(shown, sizeof shown, "%.6g", value);
    text += (text.empty() ? "" : "; ") + std::string(name) + " = " + shown + " is not accepted: " + accepted;
  };
  need(std::isfinite(m.youngsModulus) && m.youngsModulus > 0.0, "Young's modulus", m.youngsModulus, "finite and > 0 Pa");
  need(std::isfinite(m.poissonRatio) && m.poissonRatio > -1.0 && m.poissonRatio < 0.5, "Poisson's ratio", m.poissonRatio,
       "-1 < nu < 0.5");
  need(std::isfinite(m.restDensity) && m.restDensity > 0.0, "density", m.restDensity, "finite and > 0 kg/m³");
  need(std::isfinite(m.viscosity) && m.viscosity >= 0.0, "viscosity", m.viscosity, "finite and >= 0 Pa s");
  if (!text.empty()) return tl::unexpected<std::string>(text);
  return {};
}

Mat3 greenStrain(const Mat3 &F) { return 0.5 * (F.transpose() * F - Mat3::Identity()); }

double energyDensity(const Material &m, const Mat3 &F) {
  if (m.law == MaterialLaw::stVenantKirchhoff) {
    const Mat3 E = greenStrain(F);
    const double trace = E.trace();
    return 0.5 * m.lambda() * trace * trace + m.mu() * E.squaredNorm();
  }
  return 0.5 * m.mu() * (F.squaredNorm() - 3.0) + volumetric(m.lambda(), m.mu(), F.determinant()).g;
}

Mat3 firstPiolaStress(const Material &m, const Mat3 &F) {
  if (m.law == MaterialLaw::stVenantKirchhoff) {
    const Mat3 E = greenStrain(F);
    return F * (m.lambda() * E.trace() * Mat3::Identity() + 2.0 * m.mu() * E);
  }
  const Mat3 c = cofactor(F);
  const double J = F.col(0).dot(c.col(0));
  // At J near 1, mu F and g'(J) cof F nearly cancel; written with their difference so that a rotation gives no stress.
  const double g1 = volumetric(m.lambda(), m.mu(), J).g1;
  return m.mu() * (F - c) + (m.mu() + g1) * c;
}

Mat3 secondPiolaStress(const Material &m, const Mat3 &F) {
  const Mat3 E = greenStrain(F);
  if (m.law == MaterialLaw::stVenantKirchhoff || std::abs(F.determinant()) < 1e-12)
    return m.lambda() * E.trace() * Mat3::Identity() + 2.0 * m.mu() * E;
  return F.inverse() * firstPiolaStress(m, F);
}

double tangentRatio(const Material &m, const Mat3 &F) {
  const double rest = m.lambda() + 2.0 * m.mu();
  if (m.law == MaterialLaw::stVenantKirchhoff) {
    const Mat3 C = F.transpose() * F;
    const double stretch2 = largestEigenvalueBound(C);
    const double E = 0.5 * (stretch2 - 1.0);
    const double trace = 0.5 * (C.trace() - 3.0);
    return std::max(1.0, stretch2 + std::max(0.0, m.lambda() * trace + 2.0 * m.mu() * E) / rest);
  }
  const Mat3 c = cofactor(F);
  const double J = F.col(0).dot(c.col(0));
  const Volumetric v = volumetric(m.lambda(), m.mu(), J);
  const double area2 = largestEigenvalueBound(c.transpose() * c);
  // g' cof' is the geometric part: |g'| times the largest stretch.
  const double geometric = std::abs(v.g1 + m.mu()) * std::sqrt(largestEigenvalueBound(F.transpose() * F));
  return std::max(1.0, (m.mu() + v.g2 * area2 + geometric) / rest);
}

}  // namespace pointbased
