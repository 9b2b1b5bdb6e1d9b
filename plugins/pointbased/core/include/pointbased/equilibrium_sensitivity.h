// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pointbased/integrators.h"

namespace pointbased {

namespace detail {
class EquilibriumTangent;
}

/// Derivatives of an objective J(u) of a static solution u. The unit of J is that of the caller, here [J]. Loads and
/// motions are the present ones: at load factor 1 those of the scene.
struct EquilibriumSensitivity {
  /// Of a prescribed rigid motion.
  struct Support {
    Vec3 displacement = Vec3::Zero();  ///< [J]/m
    Vec3 rotation = Vec3::Zero();      ///< [J]/rad, of a small further rotation about `centre`
    Vec3 centre = Vec3::Zero();        ///< world, m: present position of the centre of the motion
  };
  /// [phyxels] [J]/N, of a force on each; zero on phyxels whose displacement is prescribed. The force on a material
  /// point has the derivative that interpolateField() returns for its binding.
  std::vector<Vec3> forces;
  std::vector<Support> supports;      ///< one per fix, then one per live support (its rotation is about its centroid)
  double foundationStiffness = 0.0;   ///< [J]/(Pa/m), of Foundation::stiffness
  double foundationTangential = 0.0;  ///< [J]/(Pa/m), of Foundation::tangential
  /// [materials] [J]/Pa, of Young's modulus with Poisson's ratio and volumeStiffness unchanged; the stiffness of
  /// supports, which follows from it, is included. NaN: a custom law has its own modulus. Empty: not requested.
  std::vector<double> youngsModuli;
  double residual = 0.0;  ///< of the equilibrium, relative to the internal forces
  int iterations = 0;     ///< of conjugate gradients
};

/// Derivatives of the reaction R of a support along a direction, R = direction · (force of the support on the body).
struct ReactionSensitivity {
  double reaction = 0.0;             ///< N, without the weight of material that the support holds directly
  double stiffness = 0.0;            ///< N/m, dR/dd of a translation d of the support along the direction
  std::vector<double> youngsModuli;  ///< [materials] N/Pa, at constant d; as EquilibriumSensitivity::youngsModuli
};

struct SensitivitySettings {
  double tolerance = 1e-9;          ///< of the linear solve, relative, in the norm of the preconditioner; > 0
  double largestResidual = 1e-3;    ///< EquilibriumSensitivity::residual of a state that is accepted; > 0
  int maxIterations = 5000;         ///< of conjugate gradients
  bool includeYoungsModuli = true;  ///< costs two force evaluations per material
};

/// Sensitivities of static solutions by the adjoint method. With the residual r(u, p) = 0 of the equilibrium and its
/// tangent K = dr/du, which is symmetric,
///
///     K λ = dJ/du on phyxels that are free,   λ = 0 on prescribed ones
///     dJ/df = λ,   dJ/du_h = (dJ/du - K λ)_h,   dJ/dp = -λ · dr/dp for stiffnesses p
///
/// so all derivatives together need one linear solve, whatever their number. The tangent is exact; its preconditioner
/// is kept between calls for the same body. dr/dE is a central difference of forces at constant u, in which they are
/// linear (or nearly so: hourglass energy with volumeStiffness).
/// @threads one at a time, for the solver and the body; bitwise identical for any number behind parallelFor
/// @source  Tortorelli and Michaleris, Design sensitivity analysis: overview and review, Inverse Problems in
///          Engineering 1, 1994 (adjoint method)
class EquilibriumSensitivitySolver {
 public:
  EquilibriumSensitivitySolver();
  ~EquilibriumSensitivitySolver();
  EquilibriumSensitivitySolver(EquilibriumSensitivitySolver &&) noexcept;
  EquilibriumSensitivitySolver &operator=(EquilibriumSensitivitySolver &&) noexcept;

  /// @param body         in equilibrium; its state is unchanged
  /// @param environment  of the solution; parallelFor is required. Stopped is thrown if its stop request is raised
  /// @param loadFactor   of the solution
  /// @param objective    [phyxels] dJ/du, [J]/m, finite; from points by spreadForces()
  /// Errors: a rigid body; contact with obstacles or walls, attachments, grabs, pressures that follow the surface,
  /// plastic flow and renewed references, none of which is differentiated; a state that is no equilibrium; a tangent
  /// that is not positive definite (buckling, or nothing holds the body); a linear solve that does not converge.
  [[nodiscard]] Result<EquilibriumSensitivity> solve(Body &body, const Environment &environment, double loadFactor,
                                                     std::span<const Vec3> objective,
                                                     const SensitivitySettings &settings = {});
  /// Sensitivities of a reaction. With w = du/dd of a translation d of the support and the potential Π of the
  /// equilibrium,
  ///
  ///     K w = -K_h direction on free phyxels,   R = dΠ/dd,   dR/dE = w · dr/dE,   dR/dd = w · K w
  ///
  /// and the terms of the held patches. One linear solve. Errors as of solve(); the forces of the body must be those of
  /// the state, as after quasiStaticStep().
  /// @param fix        of BoundaryConditions::fixes
  /// @param direction  unit
  [[nodiscard]] Result<ReactionSensitivity> solveReaction(Body &body, const Environment &environment, double loadFactor,
                                                          std::size_t fix, const Vec3 &direction,
                                                          const SensitivitySettings &settings = {});
  /// Discards the preconditioner: call it for another body, or after a change of its stiffness.
  void forget();

 private:
  [[nodiscard]] Result<void> linearise(Body &body, const Environment &environment, double loadFactor,
                                       const SensitivitySettings &settings);
  std::unique_ptr<detail::EquilibriumTangent> tangent_;
};

}  // namespace pointbased
