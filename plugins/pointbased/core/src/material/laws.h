// SPDX-License-Identifier: Apache-2.0
// Elastic laws, one type each, so that a loop over points selects the law once: withLaw(). Private to the core.
#pragma once

#include <cmath>

#include "base/polar.h"
#include "base/symmetric_eigen.h"
#include "pointbased/elastic_law.h"
#include "pointbased/material.h"

namespace pointbased::detail {

/// Constants of a law, computed once per loop.
struct Moduli {
  double lambda, mu, volume;
  const CheckedLaw *custom;
  explicit Moduli(const Material &m)
      : lambda(m.lambda()), mu(m.mu()), volume(m.volumeStiffness), custom(m.custom.get()) {}
};

inline Mat3 symmetric(const Mat3 &m) { return 0.5 * (m + m.transpose()); }
inline double dot(const Mat3 &a, const Mat3 &b) { return a.cwiseProduct(b).sum(); }

/// lambda tr(e) I + 2 mu e
inline Mat3 hooke(const Moduli &m, const Mat3 &e) {
  Mat3 s = 2.0 * m.mu * e;
  s.diagonal().array() += m.lambda * e.trace();
  return s;
}

/// k_v/2 (J - 1)^2 and its derivatives, for laws that do not depend on J.
struct VolumeTerm {
  static double energy(const Moduli &m, const Mat3 &F) {
    if (!(m.volume > 0.0)) return 0.0;
    const double d = F.determinant() - 1.0;
    return 0.5 * m.volume * d * d;
  }
  static void addStress(const Moduli &m, const Mat3 &F, Mat3 &P) {
    if (!(m.volume > 0.0)) return;
    const Mat3 c = cofactor(F);
    P += m.volume * (F.col(0).dot(c.col(0)) - 1.0) * c;
  }
  static void addDifferential(const Moduli &m, const StressTangent &t, const Mat3 &dF, Mat3 &dP) {
    if (!(m.volume > 0.0)) return;
    const Mat3 c = cofactor(t.F);
    dP += m.volume * dot(c, dF) * c + t.volumeFirst * cofactorDifferential(t.F, dF);
  }
  static void prepare(const Moduli &m, const Mat3 &F, StressTangent &t) {
    if (m.volume > 0.0) t.volumeFirst = m.volume * (F.determinant() - 1.0);
  }
};

/// The volumetric part g(J) = -mu ln J + lambda/2 (ln J)^2 + k_v/2 (J - 1)^2 of the neo-Hookean energy, and
/// derivatives. If lambda < 0 the squared logarithm is attractive in compression: at nu = -0.9 a pressure of 0.3 % of E
/// collapses the material to a point. In this case it is mu/beta (J^-beta - 1) with beta = lambda/mu > -2/3, which has
/// the same moduli at rest, is the same at lambda = 0, and is convex.
/// @source  Storakers 1986, On material representation and constitutive branching in finite compressible elasticity,
/// with one term of exponent 2
struct Volumetric {
  double g, g1, g2;
};

inline Volumetric restVolumetric(double lambda, double mu, double J) {
  const double l = std::log(J);
  if (lambda < 0.0) {
    const double beta = lambda / mu, p = std::exp(-beta * l);
    return {mu * std::expm1(-beta * l) / beta, -mu * p / J, mu * (1.0 + beta) * p / (J * J)};
  }
  return {-mu * l + 0.5 * lambda * l * l, (lambda * l - mu) / J, (lambda + mu - lambda * l) / (J * J)};
}

inline Volumetric volumetric(const Moduli &m, double J) {
  Volumetric v;
  if (J >= kNeoHookeanSwitch) {
    v = restVolumetric(m.lambda, m.mu, J);
  } else {
    v = restVolumetric(m.lambda, m.mu, kNeoHookeanSwitch);
    const double d = J - kNeoHookeanSwitch;
    v = {v.g + v.g1 * d + 0.5 * v.g2 * d * d, v.g1 + v.g2 * d, v.g2};
  }
  const double d = J - 1.0;
  return {v.g + 0.5 * m.volume * d * d, v.g1 + m.volume * d, v.g2 + m.volume};
}

/// (tr(U) I - U)^-1 with U = R^T F. Its eigenvalues, sums of two stretches, are bounded from below by kCorotatedFloor.
inline Mat3 turnMatrix(const Polar &p, const Mat3 &U) {
  const Mat3 sums = p.trace * Mat3::Identity() - U;
  if (p.trace - largestEigenvalueBound(U) > 2.0 * kCorotatedFloor) {
    const Mat3 c = cofactor(sums);
    return c / sums.col(0).dot(c.col(0));
  }
  if (!sums.allFinite()) return sums;
  const SymmetricEigen eigen = symmetricEigen(sums);
  return eigen.with(eigen.values.cwiseMax(kCorotatedFloor).cwiseInverse());
}

/// w with [w]x = twice the skew part of A: A - A^T.
inline Vec3 axial(const Mat3 &A) { return {A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1)}; }

/// M [w]x
inline Mat3 timesCross(const Mat3 &M, const Vec3 &w) {
  Mat3 product;
  product.col(0) = M.col(1) * w.z() - M.col(2) * w.y();
  product.col(1) = M.col(2) * w.x() - M.col(0) * w.z();
  product.col(2) = M.col(0) * w.y() - M.col(1) * w.x();
  return product;
}

/// dR of the polar decomposition: R^T dR = [w]x with (tr(U) I - U) w = axial(R^T dF).
inline Mat3 rotationDifferential(const Mat3 &R, const Mat3 &turn, const Mat3 &dF) {
  return timesCross(R, turn * axial(R.transpose() * dF));
}

/// Additional energy of the neo-Hookean law below the switch: stretch(J) |F - R|^2, where stretch increases smoothly
/// from zero at the switch to mu/4 at J = 0 and below. Without it W ~ mu/2 |F|^2 would contract F to a point at F = 0,
/// and mirrored states would collapse to it and remain there.
struct Collapse {
  double value, slope, curvature;
};

inline Collapse collapse(const Moduli &m, double J) {
  const double full = 0.25 * m.mu;
  if (J <= 0.0) return {full, 0.0, 0.0};
  const double s = J / kNeoHookeanSwitch;
  const double slope = -30.0 * s * s * (1.0 - s) * (1.0 - s);
  const double curvature = -60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
  return {full * (1.0 - s * s * s * (10.0 + s * (6.0 * s - 15.0))), full * slope / kNeoHookeanSwitch,
          full * curvature / (kNeoHookeanSwitch * kNeoHookeanSwitch)};
}

template <MaterialLaw law>
struct Law;

template <>
struct Law<MaterialLaw::linear> {
  static double energy(const Moduli &m, const Mat3 &F) {
    const Mat3 e = symmetric(F) - Mat3::Identity();
    const double trace = e.trace();
    return 0.5 * m.lambda * trace * trace + m.mu * e.squaredNorm() + VolumeTerm::energy(m, F);
  }
  static Mat3 stress(const Moduli &m, const Mat3 &F) {
    Mat3 P = hooke(m, symmetric(F) - Mat3::Identity());
    VolumeTerm::addStress(m, F, P);
    return P;
  }
  static StressTangent tangent(const Moduli &m, const Mat3 &F) {
    StressTangent t;
    t.F = F;
    VolumeTerm::prepare(m, F, t);
    return t;
  }
  static Mat3 differential(const Moduli &m, const StressTangent &t, const Mat3 &dF) {
    Mat3 dP = hooke(m, symmetric(dF));
    VolumeTerm::addDifferential(m, t, dF, dP);
    return dP;
  }
};

template <>
struct Law<MaterialLaw::stVenantKirchhoff> {
  static double energy(const Moduli &m, const Mat3 &F) {
    const Mat3 E = greenStrain(F);
    const double trace = E.trace();
    return 0.5 * m.lambda * trace * trace + m.mu * E.squaredNorm() + VolumeTerm::energy(m, F);
  }
  static Mat3 stress(const Moduli &m, const Mat3 &F) {
    Mat3 P = F * hooke(m, greenStrain(F));
    VolumeTerm::addStress(m, F, P);
    return P;
  }
  static StressTangent tangent(const Moduli &m, const Mat3 &F) {
    StressTangent t;
    t.F = F;
    t.frame = hooke(m, greenStrain(F));
    VolumeTerm::prepare(m, F, t);
    return t;
  }
  static Mat3 differential(const Moduli &m, const StressTangent &t, const Mat3 &dF) {
    Mat3 dP = dF * t.frame + t.F * hooke(m, symmetric(t.F.transpose() * dF));
    VolumeTerm::addDifferential(m, t, dF, dP);
    return dP;
  }
};

template <>
struct Law<MaterialLaw::corotated> {
  static double energy(const Moduli &m, const Mat3 &F) {
    const Polar p = polar(F);
    const double trace = p.trace - 3.0;
    return m.mu * (F - p.R).squaredNorm() + 0.5 * m.lambda * trace * trace + VolumeTerm::energy(m, F);
  }
  static Mat3 stress(const Moduli &m, const Mat3 &F) {
    const Polar p = polar(F);
    Mat3 P = 2.0 * m.mu * (F - p.R) + m.lambda * (p.trace - 3.0) * p.R;
    VolumeTerm::addStress(m, F, P);
    return P;
  }
  static StressTangent tangent(const Moduli &m, const Mat3 &F) {
    const Polar p = polar(F);
    StressTangent t;
    t.F = F;
    t.frame = p.R;
    t.first = 2.0 * m.mu - m.lambda * (p.trace - 3.0);
    t.turn = turnMatrix(p, symmetric(p.R.transpose() * F));
    VolumeTerm::prepare(m, F, t);
    return t;
  }
  static Mat3 differential(const Moduli &m, const StressTangent &t, const Mat3 &dF) {
    Mat3 dP =
        2.0 * m.mu * dF + m.lambda * dot(t.frame, dF) * t.frame - t.first * rotationDifferential(t.frame, t.turn, dF);
    VolumeTerm::addDifferential(m, t, dF, dP);
    return dP;
  }
};

template <>
struct Law<MaterialLaw::neoHookean> {
  static double energy(const Moduli &m, const Mat3 &F) {
    const double J = F.determinant();
    const double W = 0.5 * m.mu * (F.squaredNorm() - 3.0) + volumetric(m, J).g;
    return J >= kNeoHookeanSwitch ? W : W + collapse(m, J).value * (F - polar(F).R).squaredNorm();
  }
  static Mat3 stress(const Moduli &m, const Mat3 &F) {
    const Mat3 c = cofactor(F);
    const double J = F.col(0).dot(c.col(0));
    // Near J = 1, mu F and g'(J) cof F nearly cancel. They are written with their difference, so that a rotation causes
    // no stress.
    const Mat3 P = m.mu * (F - c) + (m.mu + volumetric(m, J).g1) * c;
    if (J >= kNeoHookeanSwitch) return P;
    const Collapse k = collapse(m, J);
    const Mat3 off = F - polar(F).R;
    return P + 2.0 * k.value * off + k.slope * off.squaredNorm() * c;
  }
  static StressTangent tangent(const Moduli &m, const Mat3 &F) {
    StressTangent t;
    t.F = F;
    const double J = F.determinant();
    const Volumetric v = volumetric(m, J);
    t.first = v.g1;
    t.second = v.g2;
    if (J >= kNeoHookeanSwitch) return t;
    const Collapse k = collapse(m, J);
    const Polar p = polar(F);
    t.frame = p.R;
    t.turn = turnMatrix(p, symmetric(p.R.transpose() * F));
    t.collapse = k.value;
    t.collapseSlope = k.slope;
    const double off = (F - p.R).squaredNorm();
    t.first += k.slope * off;
    t.second += k.curvature * off;
    return t;
  }
  static Mat3 differential(const Moduli &m, const StressTangent &t, const Mat3 &dF) {
    const Mat3 c = cofactor(t.F);
    const double dJ = dot(c, dF);
    const Mat3 dP = m.mu * dF + t.second * dJ * c + t.first * cofactorDifferential(t.F, dF);
    if (!(t.collapse > 0.0)) return dP;
    const Mat3 off = t.F - t.frame;
    return dP + 2.0 * t.collapse * (dF - rotationDifferential(t.frame, t.turn, dF)) +
           2.0 * t.collapseSlope * (dJ * off + dot(off, dF) * c);
  }
};

/// tangentRatio() if the custom law has already returned its stiffness.
[[nodiscard]] double tangentRatio(const Moduli &m, const Mat3 &F, const TangentBound &ofLaw);

/// One point at a time; loops over many points use batches (custom_batches.h).
template <>
struct Law<MaterialLaw::custom> {
  static double energy(const Moduli &m, const Mat3 &F) {
    double W = 0.0;
    m.custom->energies({&F, 1}, {&W, 1});
    return W + VolumeTerm::energy(m, F);
  }
  static Mat3 stress(const Moduli &m, const Mat3 &F) {
    Mat3 P;
    m.custom->stresses({&F, 1}, {&P, 1});
    VolumeTerm::addStress(m, F, P);
    return P;
  }
  static StressTangent tangent(const Moduli &m, const Mat3 &F) {
    StressTangent t;
    t.F = F;
    VolumeTerm::prepare(m, F, t);
    return t;
  }
  static Mat3 differential(const Moduli &m, const StressTangent &t, const Mat3 &dF) {
    Mat3 dP;
    m.custom->differentials({&t.F, 1}, {&dF, 1}, {&dP, 1});
    VolumeTerm::addDifferential(m, t, dF, dP);
    return dP;
  }
};

/// Calls body(Law<law>{}) for the law of the material, so that the switch is outside of the loop in body.
template <class Body>
decltype(auto) withLaw(MaterialLaw law, Body &&body) {
  switch (law) {
    case MaterialLaw::linear: return body(Law<MaterialLaw::linear>{});
    case MaterialLaw::stVenantKirchhoff: return body(Law<MaterialLaw::stVenantKirchhoff>{});
    case MaterialLaw::corotated: return body(Law<MaterialLaw::corotated>{});
    case MaterialLaw::custom: return body(Law<MaterialLaw::custom>{});
    case MaterialLaw::neoHookean: break;
  }
  return body(Law<MaterialLaw::neoHookean>{});
}

}  // namespace pointbased::detail
