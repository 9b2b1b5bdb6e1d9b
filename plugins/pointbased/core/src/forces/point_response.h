// SPDX-License-Identifier: Apache-2.0
// Stress of one point and its change, including material history. Private to the core.
#pragma once

#include "discretisation/rank_deficient_gradient.h"
#include "forces/cloud_stabilisation.h"
#include "forces/hourglass_energy.h"
#include "forces/point_loops.h"
#include "forces/relaxing_hourglass.h"
#include "pointbased/plasticity.h"

namespace pointbased::detail {

/// Projector onto the directions spanned by a flat stencil.
inline Mat3 seenDirections(int rank, const Mat3 &frame) {
  return frame.leftCols(rank) * frame.leftCols(rank).transpose();
}

/// Completion of small strain, linear in the displacements: no strain outside of the spanned directions.
/// @param H  displacement gradient (or its change); only its spanned part is used
inline Mat3 completedLinearly(const Mat3 &H, int rank, const Mat3 &frame) {
  const Mat3 T = seenDirections(rank, frame);
  const Mat3 seen = H * T;
  return seen - seen.transpose() * (Mat3::Identity() - T);
}

/// completedDifferential() for an isotropic stress. A line is rotated without the twist about itself: such a stress
/// does not depend on it, and it grows without bound near a rotation by 180 degrees.
inline Mat3 completedWithoutTwist(const Mat3 &F, const Mat3 &dFit, int rank, const Mat3 &frame) {
  if (rank != 1) return completedDifferential(F, dFit, rank, frame);
  const Vec3 t = frame.col(0), a = F * t, da = dFit * t;
  const double squared = a.squaredNorm();
  Mat3 dF = da * t.transpose();
  if (!(squared > 0.0)) return dF;
  const Vec3 w = a.cross(da) / squared;
  const Mat3 across = F - a * t.transpose();
  for (int c = 0; c < 3; ++c) dF.col(c) += w.cross(across.col(c));
  return dF;
}

/// F passed to a law: for the linear law flat stencils are completed linearly, so that it remains linear.
template <class Law>
Mat3 lawGradient(Law, const StencilSet &s, std::size_t q, const Mat3 &F) {
  if constexpr (std::is_same_v<Law, detail::Law<MaterialLaw::linear>>) {
    if (s.rank[q] < 3) return Mat3::Identity() + completedLinearly(F - Mat3::Identity(), s.rank[q], frameOfPoint(s, q));
  }
  return F;
}

/// Change of lawGradient().
/// @param F  completed
/// @param dFit  change of the fitted gradient
template <class Law>
Mat3 lawGradientDifferential(Law, const StencilSet &s, std::size_t q, const Mat3 &F, const Mat3 &dFit) {
  if (s.rank[q] == 3) return dFit;
  if constexpr (std::is_same_v<Law, detail::Law<MaterialLaw::linear>>)
    return completedLinearly(dFit, s.rank[q], frameOfPoint(s, q));
  return completedWithoutTwist(F, dFit, s.rank[q], frameOfPoint(s, q));
}

/// Points of one material over one step: the parts of the response are selected here, not per point.
struct PointResponse {
  const Material &material;
  const StencilSet &stencils;
  const PointHistory &before;
  bool plastic, relaxing, viscous;
  PronyStep step;

  PointResponse(const Material &m, const StencilSet &s, const PointHistory &history, double dt, bool rates)
      : material(m), stencils(s), before(history), plastic(!history.plasticInverse.empty() && m.plastic.enabled()),
        relaxing(!history.prony.empty() && m.relaxes()), viscous(rates && m.viscosity > 0.0) {
    if (relaxing) step = pronyStep(m, dt);
  }

  [[nodiscard]] bool elastic() const { return !plastic && !relaxing && !viscous; }

  /// For the modes, which relax if they have a history.
  [[nodiscard]] PronyStep hourglassStep() const { return before.modes.empty() ? PronyStep() : step; }
  [[nodiscard]] HourglassStrain hourglassPast(std::size_t q) const {
    return before.modes.empty() ? HourglassStrain(HourglassStrain::Zero()) : pastOf(step, before.modes[q]);
  }

  /// P with history, Pa.
  /// @param rate   dF/dt of the fit; only with `viscous`
  /// @param after  out: the Prony terms at the end of the step; only with `relaxing`
  [[nodiscard]] Mat3 stress(std::size_t q, const Mat3 &F, const Mat3 &rate, PronyPoint &after) const {
    const Mat3 Fe = elasticPart(q, F);
    Mat3 P = relaxing ? pronyStress(material, step, Fe, before.prony[q], after) : firstPiolaStress(material, Fe);
    if (plastic) P = P * before.plasticInverse[q].transpose();
    if (viscous) P += viscousStress(q, F, rate);
    return P;
  }

  /// dP for a change of the fit; exact at fixed history.
  /// @param viscousScale  1/s: dF/dt = viscousScale dF
  [[nodiscard]] Mat3 differential(std::size_t q, const Mat3 &F, const Mat3 &dFit, double viscousScale) const {
    Mat3 dFe = withLaw(material.law, [&](auto law) { return lawGradientDifferential(law, stencils, q, F, dFit); });
    if (plastic) dFe = dFe * before.plasticInverse[q];
    const Mat3 Fe = elasticPart(q, F);
    Mat3 dP;
    if (relaxing) {
      PronyPoint at;
      (void)pronyStress(material, step, Fe, before.prony[q], at);
      dP = pronyStressDifferential(material, step, Fe, at, dFe);
    } else {
      dP = stressDifferential(material, Fe, dFe);
    }
    if (plastic) dP = dP * before.plasticInverse[q].transpose();
    if (viscous) dP += viscousStress(q, F, viscousScale * dFit);
    return dP;
  }

  // F S_v, S_v = 2 eta dE/dt. A rotating patch is not strained: only the directions of the stencil contribute.
  [[nodiscard]] Mat3 viscousStress(std::size_t q, const Mat3 &F, const Mat3 &rate) const {
    Mat3 strainRate = symmetric(F.transpose() * rate);
    if (stencils.rank[q] < 3) {
      const Mat3 seen = seenDirections(stencils.rank[q], frameOfPoint(stencils, q));
      strainRate = seen * strainRate * seen;
    }
    return F * (2.0 * material.viscosity * strainRate);
  }

 private:
  [[nodiscard]] Mat3 elasticPart(std::size_t q, const Mat3 &F) const {
    const Mat3 G = material.law == MaterialLaw::linear ? lawGradient(Law<MaterialLaw::linear>(), stencils, q, F) : F;
    return plastic ? Mat3(G * before.plasticInverse[q]) : G;
  }
};

}  // namespace pointbased::detail
