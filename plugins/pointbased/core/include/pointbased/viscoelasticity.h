// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/material.h"

namespace pointbased {

/// Memory of a point. All zero: never strained.
struct PronyPoint {
  Mat3 previous = Mat3::Zero();                              ///< D at the end of the last step, Pa
  std::array<Mat3, 2> internal{Mat3::Zero(), Mat3::Zero()};  ///< Q: stress that each term has relaxed so far, Pa
};

/// Strain of the modes of a lattice cell (see the theory page of the lattice) in the frame of X, 1/m: Q^T F^T (a_xy,
/// a_xz, a_yz), and Q^T F^T a_xyz, 1/m².
using HourglassStrain = Eigen::Matrix<double, 3, 4>;

/// Memory of the modes of a cell. All zero: never strained.
struct HourglassHistory {
  HourglassStrain previous = HourglassStrain::Zero();  ///< deviatoric hourglass strain at the end of the last step
  /// Β: strain that each term has relaxed so far
  std::array<HourglassStrain, 2> relaxed{HourglassStrain::Zero(), HourglassStrain::Zero()};
};

/// Factors of one step, the same for all points; compute once per step.
struct PronyStep {
  std::array<double, 2> keep{1.0, 1.0}, fresh{}, old{};
  double freshSum = 0.0;
};

/// @param dt  s, >= 0; 0: nothing relaxes
[[nodiscard]] PronyStep pronyStep(const Material &material, double dt);

/// First Piola-Kirchhoff stress with relaxation, Pa, and the point's memory at the end of the step.
///
/// The elastic law is the instantaneous response. Each term subtracts a stress Q_k that grows towards its share of the
/// stress D of the shear modulus. Both are expressed in the law's own measure of strain e, as its work conjugates:
///
///   dQ_k/dt = (g_k D - Q_k) / tau_k,   P = dW/dF - d/dF (Q : e(F)) at fixed Q,   Q = Q_1 + Q_2
///
///   linear        e = sym F - I          D = 2 mu dev e
///   StVK          e = E                  D = 2 mu dev E                                 P = dW/dF - F Q
///   corotated     e = U - I, F = R U     D = 2 mu dev U                                 P = dW/dF - R (Q + [a]x)
///   neo-Hookean   e = J^(-2/3) C / 2     D = J^(2/3) DEV S, DEV X = X - (X : C)/3 C^-1  P = dW/dF - J^(-2/3) F DEV Q
///
/// Solved exactly for a D that is linear in time over the step, h = dt / tau, f = (1 - exp(-h)) / h:
///
///   Q <- exp(-h) Q + g [(1 - f) D_new + (f - exp(-h)) D_old]
///
/// equivalent to the recursion H <- exp(-h) H + g f (D_new - D_old) of the remaining stress, H = g D - Q, in a form
/// that changes nothing at dt = 0. All factors are >= 0 and sum to g (1 - exp(-h)): stable for every dt; second order
/// in dt. The instantaneous response has the instantaneous modulus; the long-term response is the share 1 - sum g of D.
/// A pure change of volume does not relax. Objective and without torque (except for the linear law). The first three
/// are linear viscoelasticity in e, so no closed cycle returns net work; for the neo-Hookean law this is tested, not
/// proved. Its driving stress fades out from J = kNeoHookeanSwitch to 0 and J^(-2/3) stays finite: an inverted point
/// loses its memory, and recovers as its elastic law does.
///
/// @param before  memory at the start of the step
/// @param after   out: memory at its end; may be the same object. With dt = 0 Q is unchanged and `previous` becomes
///                D(F), as after a jump. For a body with plastic flow pass F Fp^-1 and multiply P by Fp^-T, see
///                plasticity.h
/// @threads any
/// @source  Taylor, Pister and Goudreau, IJNME 2, 1970 (recursion); Simo, CMAME 60, 1987 (neo-Hookean); the other
///          measures and the fading: own
[[nodiscard]] Mat3 pronyStress(const Material &material, const PronyStep &step, const Mat3 &F, const PronyPoint &before,
                               PronyPoint &after);
[[nodiscard]] Mat3 pronyStress(const Material &material, const Mat3 &F, double dt, const PronyPoint &before,
                               PronyPoint &after);

/// d/ds P(F + s dF) of pronyStress() at s = 0 for a fixed `before`, Pa: exact. Symmetric; for the neo-Hookean law only
/// as far as dt / tau or the change of volume is small, because its D depends on the volume.
/// @param at  `after` as returned by pronyStress() at the same F
[[nodiscard]] Mat3 pronyStressDifferential(const Material &material, const PronyStep &step, const Mat3 &F,
                                           const PronyPoint &at, const Mat3 &dF);

}  // namespace pointbased
