// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/material.h"

namespace pointbased {

/// A point with det F at or below this value does not flow. Its Hencky strain is unbounded or undefined, and it is
/// passing through an inversion, which is not caused by the material and must not become its shape.
inline constexpr double kSmallestFlowRatio = 1e-3;

/// H = ln(F^T F) / 2, the Hencky strain; NaN where det F <= 0.
[[nodiscard]] Mat3 henckyStrain(const Mat3 &F);

/// Norm (root of the sum of squares) of the deviator of the Hencky strain, with which yield and max are compared. In
/// pure shear with stretches e^s, e^-s it is sqrt(2) s; in volume-preserving tension to the stretch L it is sqrt(3/2)
/// ln L.
[[nodiscard]] double deviatoricHenckyNorm(const Mat3 &F);

struct FlowResult {
  double elasticStrain = 0.0;  ///< norm of the elastic deviatoric Hencky strain after the flow
  double plasticStrain = 0.0;  ///< norm of the plastic Hencky strain after the flow
  double flowed = 0.0;         ///< norm of the plastic increment, before the cap; 0: elastic
  bool capped = false;         ///< limited by Plasticity::max
};

/// Fraction of the strain above yield that flows in dt (s), 1 - (1 - creep)^(dt / creepTime).
[[nodiscard]] double flowShare(const Plasticity &plastic, double dt);

/// Plastic flow of a point over dt.
///
/// F = Fe Fp with det Fp = 1. With the elastic deviatoric Hencky strain h of Fe, of norm |h| and direction N = h/|h|,
///
///   flow = (|h| - yield) (1 - (1 - creep)^(dt / creepTime)),   Fp^-1 <- Fp^-1 exp(-flow N)
///
/// which is exact at constant F for any dt. It dissipates energy where the axis of larger stretch carries the larger
/// Kirchhoff stress: neo-Hookean always, corotated and StVK unless crushed (stretches above 0.8 or so). The linear law
/// is not suitable for flow, because it treats the rotation of Fe as strain. exp of a traceless matrix has determinant
/// one; round-off is divided out. If the norm of ln(Fp^T Fp)/2 exceeds `max`, Fp is scaled back to it in logarithm
/// (projection on a ball).
///
/// @param plasticInverse  in and out: Fp^-1; start with the identity
/// @param result          null, or details of the flow; the strains are filled only if something flowed
/// @param before          null, or F_p^-1 of the flow before the reference was renewed (rereferencing.h); `max` and
///                        plasticStrain then refer to the total flow, F_p F_p,before
/// @return  false, with plasticInverse unchanged bit for bit, if nothing flows: not enabled(), below yield, dt <= 0,
///          det F <= kSmallestFlowRatio, F not finite
/// @threads any; a point clearly below yield costs no eigenvalues
/// @source  Simo, CMAME 99, 1992 (exponential map); O'Brien et al., SIGGRAPH 2002 (yield, creep, max); rate form: own
bool plasticFlow(const Plasticity &plastic, const Mat3 &F, double dt, Mat3 &plasticInverse,
                 FlowResult *result = nullptr, const Mat3 *before = nullptr);

/// P = P_e(F Fp^-1) Fp^-T, Pa: force per rest area.
[[nodiscard]] Mat3 elastoplasticStress(const Material &material, const Mat3 &F, const Mat3 &plasticInverse);

/// W(F Fp^-1), J/m³ of rest volume: the stored, recoverable energy.
[[nodiscard]] double elastoplasticEnergyDensity(const Material &material, const Mat3 &F, const Mat3 &plasticInverse);

/// d/ds elastoplasticStress(F + s dF) at s = 0 with constant Fp, Pa: exact where flow follows the step.
[[nodiscard]] Mat3 elastoplasticStressDifferential(const Material &material, const Mat3 &F, const Mat3 &plasticInverse,
                                                   const Mat3 &dF);

/// tangentRatio() with constant Fp: times the largest stretch of Fp^-1 squared.
[[nodiscard]] double elastoplasticTangentRatio(const Material &material, const Mat3 &F, const Mat3 &plasticInverse);

}  // namespace pointbased
