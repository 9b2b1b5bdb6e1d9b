// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/types.h"

namespace pointbased {

enum class MaterialLaw {
  stVenantKirchhoff,  ///< linear in Green strain; softens in compression, has no force at zero volume
  neoHookean          ///< compressible, log form; continued below kNeoHookeanSwitch so that it recovers from inversion
};

/// An isotropic elastic body with viscous damping.
struct Material {
  MaterialLaw law = MaterialLaw::neoHookean;
  double youngsModulus = 6000.0;  ///< Pa, > 0
  double poissonRatio = 0.45;     ///< -1 < nu < 0.5; near 0.5 the stable step shrinks
  double restDensity = 1060.0;    ///< kg/m³, > 0
  double viscosity = 0.0;         ///< Pa s, >= 0: S_v = 2 eta dE/dt; damps deformation, not rigid motion

  [[nodiscard]] double lambda() const {
    return youngsModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio));
  }
  [[nodiscard]] double mu() const { return youngsModulus / (2.0 * (1.0 + poissonRatio)); }
};

/// All that is wrong with it, or nothing.
[[nodiscard]] Result<void> validate(const Material &material);

/// Below this volume ratio the volumetric part of the neo-Hookean energy goes on as its second-order Taylor polynomial:
/// twice continuously differentiable, finite and pushing outwards at J = 0 and below.
inline constexpr double kNeoHookeanSwitch = 0.25;

/// E = (F^T F - I) / 2
[[nodiscard]] Mat3 greenStrain(const Mat3 &F);

/// W(F), J/m³.
///
/// StVK: W = lambda/2 tr(E)^2 + mu E:E.  Neo-Hookean: W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/2 (ln J)^2.
/// @source  Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd ed., ch. 6.4
[[nodiscard]] double energyDensity(const Material &material, const Mat3 &F);

/// P = dW/dF, Pa: force per rest area; f_j = -v P g_j.
[[nodiscard]] Mat3 firstPiolaStress(const Material &material, const Mat3 &F);

/// S = F^-1 P, Pa; for a singular F the StVK value.
[[nodiscard]] Mat3 secondPiolaStress(const Material &material, const Mat3 &F);

/// How much stiffer the tangent at F is than at rest: an upper estimate of the ratio of the largest moduli of dP/dF.
/// The stable step shrinks with its square root.
[[nodiscard]] double tangentRatio(const Material &material, const Mat3 &F);

}  // namespace pointbased
