// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <memory>

#include "pointbased/types.h"

namespace pointbased {

class CheckedLaw;

enum class MaterialLaw {
  linear,  ///< small strain: not objective, a rotation by w causes a strain of w²/2; recovers, but to F = I
  /// linear in Green strain; softens in compression, also has a mirrored rest state: stays inverted
  stVenantKirchhoff,
  corotated,   ///< linear in the stretch; finite everywhere, recovers; kinks where the rotation is not unique
  neoHookean,  ///< compressible, log form; continued below kNeoHookeanSwitch so that it recovers from inversion
  custom       ///< Material::custom, of elastic_law.h; not with Prony terms or plasticity
};

/// One term of the relaxation of the shear modulus.
struct PronyTerm {
  double share = 0.0;  ///< 0 ... < 1: part of the instantaneous shear modulus that relaxes; 0 = no term
  double time = 0.0;   ///< s, > 0 where share > 0: after it 63 % of the share has relaxed
};

/// Volume-preserving plastic flow; see plasticity.h.
struct Plasticity {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double yield = kNever;  ///< norm of the elastic deviatoric Hencky strain, >= 0; flow begins above; inf = elastic
  double creep = 0.0;     ///< 0 ... 1: share of the excess that flows within creepTime; 1 = instantly, 0 = elastic
  double creepTime = 1.0 / 60.0;  ///< s, > 0; what flows in dt is 1 - (1 - creep)^(dt / creepTime) of the excess
  double max = kNever;            ///< cap of the norm of the plastic Hencky strain, >= 0; 0 = elastic, inf = melts

  /// False if nothing can ever flow: the stage is then skipped and the body is elastic bit for bit.
  [[nodiscard]] bool enabled() const { return yield < kNever && creep > 0.0 && max > 0.0; }
};

/// An isotropic solid: elastic law, viscous damping, and optionally volume conservation, relaxation and flow.
struct Material {
  MaterialLaw law = MaterialLaw::neoHookean;
  double youngsModulus = 6000.0;  ///< Pa, > 0; with Prony terms the instantaneous one
  double poissonRatio = 0.45;     ///< -1 < nu < 0.5; near 0.5 the stable step shrinks
  double restDensity = 1060.0;    ///< kg/m³, > 0
  double viscosity = 0.0;         ///< Pa s, >= 0: S_v = 2 eta dE/dt; damps deformation, not rigid motion
  double volumeStiffness = 0.0;   ///< Pa, >= 0: W += k_v/2 (J - 1)^2; in addition to Poisson's ratio, see bulkModulus()
  std::array<PronyTerm, 2> prony{};  ///< G(t) = G0 (1 - sum share (1 - exp(-t / time))), deviatoric part only
  Plasticity plastic{};
  std::shared_ptr<const CheckedLaw>
      custom{};  ///< of MaterialLaw::custom; Young's modulus and Poisson's ratio are then its own

  [[nodiscard]] double lambda() const {
    return youngsModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio));
  }
  [[nodiscard]] double mu() const { return youngsModulus / (2.0 * (1.0 + poissonRatio)); }
  /// Effective bulk modulus at rest, Pa: lambda + 2/3 mu + k_v.
  [[nodiscard]] double bulkModulus() const { return lambda() + 2.0 / 3.0 * mu() + volumeStiffness; }
  /// Modulus of the pressure wave at rest, Pa: lambda + 2 mu + k_v = density c_p².
  [[nodiscard]] double waveModulus() const { return lambda() + 2.0 * mu() + volumeStiffness; }
  [[nodiscard]] bool relaxes() const { return prony[0].share > 0.0 || prony[1].share > 0.0; }
};

/// Sets an external law, with its Young's modulus and Poisson's ratio at rest.
void setLaw(Material &material, std::shared_ptr<const CheckedLaw> law);

/// Errors: text lists everything that is invalid.
[[nodiscard]] Result<void> validate(const Material &material);

/// Below this volume ratio the volumetric part of the neo-Hookean energy continues as its second-order Taylor
/// polynomial: twice continuously differentiable, finite and pushing outwards at J = 0 and below. There mu/4 |F - R|^2
/// is blended in (R as of the corotated law), because without it a point, F = 0, would be a rest state that attracts
/// mirrored states.
inline constexpr double kNeoHookeanSwitch = 0.25;

/// Lower limit of sums of two singular values (the smaller one with the sign of J) in the differential of the corotated
/// law, where the rotation rate is unbounded.
inline constexpr double kCorotatedFloor = 1e-4;

/// E = (F^T F - I) / 2
[[nodiscard]] Mat3 greenStrain(const Mat3 &F);

/// W(F), J/m³, of the instantaneous elastic law; every law gets k_v/2 (J - 1)^2 in addition.
///
/// linear: eps = sym(F) - I, W = lambda/2 tr(eps)^2 + mu eps:eps.  StVK: the same with E instead of eps.
/// corotated: W = mu |F - R|^2 + lambda/2 (tr(R^T F) - 3)^2, R the proper rotation next to F (also for det F <= 0).
/// neo-Hookean: W = mu/2 (tr(F^T F) - 3) + g(J), g = -mu ln J + lambda/2 (ln J)^2; nu < 0: mu/b (J^-b - 1),
/// b = lambda/mu.  custom: defined by the law.
/// @source  Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd ed., ch. 6.4; k_v: Müller et
///          al., Point Based Animation of Elastic, Plastic and Melting Objects, SCA 2004, with J for |J|
[[nodiscard]] double energyDensity(const Material &material, const Mat3 &F);

/// P = dW/dF, Pa: force per rest area; f_j = -v P g_j.
[[nodiscard]] Mat3 firstPiolaStress(const Material &material, const Mat3 &F);

/// S = F^-1 P, Pa; for a singular F the StVK value; for the linear law P, which small strains do not distinguish from
/// S.
[[nodiscard]] Mat3 secondPiolaStress(const Material &material, const Mat3 &F);

/// sigma = P F^T / J, Pa; where |J| < 1e-12 it is evaluated with |J| = 1e-12; for the linear law P.
[[nodiscard]] Mat3 cauchyStress(const Material &material, const Mat3 &F);

/// d/ds P(F + s dF) at s = 0, Pa: exact; a symmetric bilinear form, not always positive definite.
[[nodiscard]] Mat3 stressDifferential(const Material &material, const Mat3 &F, const Mat3 &dF);

/// Terms of stressDifferential that depend on F only, for many dF: no logarithm and no rotation per dF.
struct StressTangent {
  Mat3 F;
  Mat3 frame;                  ///< StVK: S; corotated, and neo-Hookean below the switch: R
  Mat3 turn;                   ///< where frame is R: (tr(R^T F) I - R^T F)^-1, limited by kCorotatedFloor
  double first = 0.0;          ///< neo-Hookean: dW/dJ; corotated: 2 mu - lambda (tr(R^T F) - 3)
  double second = 0.0;         ///< d²W/dJ²
  double volumeFirst = 0.0;    ///< k_v (J - 1), laws other than neo-Hookean
  double collapse = 0.0;       ///< neo-Hookean below the switch: factor of |F - R|²
  double collapseSlope = 0.0;  ///< its derivative with respect to J
};
[[nodiscard]] StressTangent stressTangent(const Material &material, const Mat3 &F);
[[nodiscard]] Mat3 stressDifferential(const Material &material, const StressTangent &tangent, const Mat3 &dF);

/// Stiffness of the tangent at F relative to rest, >= 1: never below the larger of two ratios to rest, of the fastest
/// wave (largest a⊗n : dP/dF : a⊗n) and of the largest eigenvalue of dP/dF. The stable step decreases with its square
/// root.
///
/// @threads any
/// @source  own: along a⊗n J is linear, so that the wave modulus of the neo-Hookean law is mu + W''(J) |cof F|²; that
///          of StVK is S_1 + (lambda + 2 mu) s_1²; largest eigenvalues bounded by Laguerre's method from above
[[nodiscard]] double tangentRatio(const Material &material, const Mat3 &F);

}  // namespace pointbased
