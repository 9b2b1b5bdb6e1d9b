// SPDX-License-Identifier: Apache-2.0
#include "pointbased/viscoelasticity.h"

#include <algorithm>
#include <cmath>

#include "material/laws.h"
#include "material/relaxation.h"

namespace pointbased {

using detail::dot;
using detail::Moduli;
using detail::symmetric;

namespace {

constexpr double kThird = 1.0 / 3.0;

Mat3 deviator(const Mat3 &s) { return s - s.trace() * kThird * Mat3::Identity(); }

struct Value {
  double value, slope;
};

// J^(2/3), reduced smoothly to zero between the switch and J = 0, twice continuously differentiable.
Value driveFactor(double J) {
  if (J <= 0.0) return {0.0, 0.0};
  const double root = std::cbrt(J);
  if (J >= kNeoHookeanSwitch) return {root * root, 2.0 * kThird / root};
  const double s = J / kNeoHookeanSwitch;
  const double fade = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  const double fadeSlope = 30.0 * s * s * (s - 1.0) * (s - 1.0) / kNeoHookeanSwitch;
  return {root * root * fade, 2.0 * kThird / root * fade + root * root * fadeSlope};
}

// m(J) = J^(-2/3); below the switch its slope decreases linearly to zero at J = 0, constant below that.
struct PushFactor {
  double value, slope, curvature;
};

PushFactor pushFactor(double J) {
  if (J >= kNeoHookeanSwitch) {
    const double root = std::cbrt(J);
    const double value = 1.0 / (root * root);
    const double slope = -2.0 * kThird * value / J;
    return {value, slope, -5.0 * kThird * slope / J};
  }
  const PushFactor at = pushFactor(kNeoHookeanSwitch);
  const double j = std::max(J, 0.0);
  const double curvature = at.slope / kNeoHookeanSwitch;
  return {at.value + 0.5 * curvature * (j * j - kNeoHookeanSwitch * kNeoHookeanSwitch), curvature * j,
          J > 0.0 ? curvature : 0.0};
}

// Per law, at one F: drive() = D(F), the stress of the shear modulus in the law's own measure of strain e, and
// pushed(Q) = d/dF (Q : e(F)); with their differentials.
template <MaterialLaw law>
struct Relaxation;

// e = sym F - I
template <>
struct Relaxation<MaterialLaw::linear> {
  const Mat3 &F;
  explicit Relaxation(const Mat3 &at) : F(at) {}

  Mat3 drive(const Moduli &m) const { return 2.0 * m.mu * deviator(symmetric(F)); }
  Mat3 driveDifferential(const Moduli &m, const Mat3 &dF) const { return 2.0 * m.mu * deviator(symmetric(dF)); }
  Mat3 pushed(const Mat3 &Q) const { return Q; }
  Mat3 pushedDifferential(const Mat3 &, const Mat3 &, const Mat3 &dQ) const { return dQ; }
};

// e = (F^T F - I) / 2
template <>
struct Relaxation<MaterialLaw::stVenantKirchhoff> {
  const Mat3 &F;
  explicit Relaxation(const Mat3 &at) : F(at) {}

  Mat3 drive(const Moduli &m) const { return 2.0 * m.mu * deviator(greenStrain(F)); }
  Mat3 driveDifferential(const Moduli &m, const Mat3 &dF) const {
    return 2.0 * m.mu * deviator(symmetric(F.transpose() * dF));
  }
  Mat3 pushed(const Mat3 &Q) const { return F * Q; }
  Mat3 pushedDifferential(const Mat3 &Q, const Mat3 &dF, const Mat3 &dQ) const { return dF * Q + F * dQ; }
};

// e = U - I, U = R^T F. Q need not have the axes of U: R (Q + [a]x) with the a that causes no torque, that is
// (tr(U) I - U) a = axial of U Q - Q U.
template <>
struct Relaxation<MaterialLaw::corotated> {
  Mat3 R, U, turn;
  explicit Relaxation(const Mat3 &F) {
    const detail::Polar p = detail::polar(F);
    R = p.R;
    U = symmetric(R.transpose() * F);
    turn = detail::turnMatrix(p, U);
  }

  Mat3 drive(const Moduli &m) const { return 2.0 * m.mu * deviator(U); }
  Mat3 driveDifferential(const Moduli &m, const Mat3 &dF) const {
    return 2.0 * m.mu * deviator(stretchDifferential(dF, spin(dF)));
  }
  Mat3 pushed(const Mat3 &Q) const { return R * Q + detail::timesCross(R, turn * detail::axial(U * Q)); }
  Mat3 pushedDifferential(const Mat3 &Q, const Mat3 &dF, const Mat3 &dQ) const {
    const Vec3 w = spin(dF);
    const Mat3 dU = stretchDifferential(dF, w);
    const Mat3 dR = detail::timesCross(R, w);
    const Vec3 a = turn * detail::axial(U * Q);
    const Vec3 da = turn * (detail::axial(dU * Q + U * dQ) - (dU.trace() * a - dU * a));
    return dR * Q + R * dQ + detail::timesCross(dR, a) + detail::timesCross(R, da);
  }

 private:
  Vec3 spin(const Mat3 &dF) const { return turn * detail::axial(R.transpose() * dF); }  // R^T dR = [spin]x
  Mat3 stretchDifferential(const Mat3 &dF, const Vec3 &w) const {
    return symmetric(R.transpose() * dF - detail::timesCross(Mat3::Identity(), w) * U);
  }
};

// e = C J^(-2/3) / 2: J^(2/3) DEV S of mu/2 tr C, and Q : e with J^(-2/3) held finite.
template <>
struct Relaxation<MaterialLaw::neoHookean> {
  const Mat3 &F;
  Mat3 c;
  double J;
  explicit Relaxation(const Mat3 &at) : F(at), c(detail::cofactor(at)), J(F.col(0).dot(c.col(0))) {}

  Mat3 drive(const Moduli &m) const {
    const Value factor = driveFactor(J);
    if (!(factor.value > 0.0)) return Mat3::Zero();
    return m.mu * factor.value * (Mat3::Identity() - F.squaredNorm() * kThird / (J * J) * (c.transpose() * c));
  }
  Mat3 driveDifferential(const Moduli &m, const Mat3 &dF) const {
    const Value factor = driveFactor(J);
    if (!(factor.value > 0.0)) return Mat3::Zero();
    const Mat3 inverse = c.transpose() / J;
    const Mat3 inverseC = inverse * inverse.transpose();
    const Mat3 dInverseC = -2.0 * symmetric(inverse * dF * inverseC);
    const double size = F.squaredNorm() * kThird;
    return m.mu * (factor.slope * dot(c, dF) * (Mat3::Identity() - size * inverseC) -
                   factor.value * (2.0 * kThird * dot(F, dF) * inverseC + size * dInverseC));
  }
  Mat3 pushed(const Mat3 &Q) const {
    const PushFactor factor = pushFactor(J);
    const Mat3 FQ = F * Q;
    return factor.value * FQ + 0.5 * factor.slope * dot(FQ, F) * c;
  }
  Mat3 pushedDifferential(const Mat3 &Q, const Mat3 &dF, const Mat3 &dQ) const {
    const PushFactor factor = pushFactor(J);
    const Mat3 FQ = F * Q;
    const Mat3 FdQ = F * dQ;
    const double dJ = dot(c, dF);
    const double QC = dot(FQ, F);
    const double dQC = dot(FdQ, F) + 2.0 * dot(FQ, dF);
    return factor.value * (dF * Q + FdQ) + factor.slope * (dJ * FQ + 0.5 * dQC * c) +
           0.5 * QC * (factor.curvature * dJ * c + factor.slope * detail::cofactorDifferential(F, dF));
  }
};

// Never used: validate() rejects relaxation of custom laws, whose parts are unknown.
template <>
struct Relaxation<MaterialLaw::custom> : Relaxation<MaterialLaw::neoHookean> {
  using Relaxation<MaterialLaw::neoHookean>::Relaxation;
};

template <MaterialLaw law>
Relaxation<law> relaxationAt(detail::Law<law>, const Mat3 &F) {
  return Relaxation<law>(F);
}

}  // namespace

Mat3 detail::pronyDrive(const Material &material, const Mat3 &F) {
  return withLaw(material.law, [&](auto law) -> Mat3 { return relaxationAt(law, F).drive(Moduli(material)); });
}

Mat3 detail::pronyPushed(const Material &material, const Mat3 &F, const Mat3 &Q) {
  return withLaw(material.law, [&](auto law) -> Mat3 { return relaxationAt(law, F).pushed(Q); });
}

PronyStep pronyStep(const Material &material, double dt) {
  PronyStep step;
  for (std::size_t k = 0; k < 2; ++k) {
    const PronyTerm &term = material.prony[k];
    if (!(term.share > 0.0) || !(dt > 0.0)) continue;
    const double h = dt / term.time;
    const double keep = std::exp(-h);
    const double f = -std::expm1(-h) / h;
    step.keep[k] = keep;
    step.fresh[k] = term.share * (1.0 - f);
    step.old[k] = term.share * (f - keep);
    step.freshSum += step.fresh[k];
  }
  return step;
}

Mat3 pronyStress(const Material &material, const PronyStep &step, const Mat3 &F, const PronyPoint &before,
                 PronyPoint &after) {
  const Mat3 P = firstPiolaStress(material, F);
  if (!material.relaxes()) {
    after = before;
    return P;
  }
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) -> Mat3 {
    const auto relaxation = relaxationAt(law, F);
    const Mat3 D = relaxation.drive(m);
    Mat3 Q = Mat3::Zero();
    for (std::size_t k = 0; k < 2; ++k) {
      after.internal[k] = step.keep[k] * before.internal[k] + step.fresh[k] * D + step.old[k] * before.previous;
      Q += after.internal[k];
    }
    after.previous = D;
    return P - relaxation.pushed(Q);
  });
}

Mat3 pronyStress(const Material &material, const Mat3 &F, double dt, const PronyPoint &before, PronyPoint &after) {
  return pronyStress(material, pronyStep(material, dt), F, before, after);
}

Mat3 pronyStressDifferential(const Material &material, const PronyStep &step, const Mat3 &F, const PronyPoint &at,
                             const Mat3 &dF) {
  const Mat3 dP = stressDifferential(material, F, dF);
  if (!material.relaxes()) return dP;
  const Moduli m(material);
  return detail::withLaw(material.law, [&](auto law) -> Mat3 {
    const auto relaxation = relaxationAt(law, F);
    Mat3 dQ = Mat3::Zero();
    if (step.freshSum > 0.0) dQ = step.freshSum * relaxation.driveDifferential(m, dF);
    return dP - relaxation.pushedDifferential(at.internal[0] + at.internal[1], dF, dQ);
  });
}

}  // namespace pointbased
