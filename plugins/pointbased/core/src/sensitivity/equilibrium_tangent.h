// SPDX-License-Identifier: Apache-2.0
// Linear solves with the tangent of a body in static equilibrium. Private to the core.
#pragma once

#include <optional>

#include "solvers/conjugate_gradients.h"
#include "solvers/preconditioner.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {

/// v = 0 on prescribed phyxels.
void clearPrescribed(const IncrementalPotential &problem, std::span<Vec3> v);

/// K^-1 b for the Hessian K of a potential at its present state, by preconditioned conjugate gradients. The
/// preconditioner is kept between solves.
class TangentSolver {
 public:
  /// x = K^-1 b on free phyxels, 0 on prescribed ones; b on prescribed phyxels is ignored.
  /// @param tolerance  relative, in the norm of the preconditioner
  /// Errors: a Hessian that is not positive definite; no convergence within maxIterations.
  [[nodiscard]] Result<void> solve(IncrementalPotential &problem, std::span<const Vec3> b, std::span<Vec3> x,
                                   double tolerance, int maxIterations, Preconditioner choice, const StopRequest *stop);
  [[nodiscard]] int iterations() const { return iterations_; }  ///< of conjugate gradients, of the last solve
  void forget() { keeper_.forget(); }

 private:
  PreconditionerOfParts keeper_;
  ConjugateGradients linear_;
  std::vector<Vec3> right_;
  int iterations_ = 0;
};

/// The tangent K of the static residual at the present displacements of a body, without contact. One thread at a time.
class EquilibriumTangent {
 public:
  /// Refers to the body until the next call; environment and body must outlive the solves. The state is unchanged.
  /// Errors: what EquilibriumSensitivitySolver::solve() refuses, except for the residual.
  [[nodiscard]] Result<void> linearise(Body &body, const Environment &environment, double loadFactor);
  /// |r| of free phyxels over |internal forces|; 0 for a body without forces.
  [[nodiscard]] double residual() const { return residual_; }
  /// TangentSolver::solve() with K.
  [[nodiscard]] Result<void> solve(std::span<const Vec3> b, std::span<Vec3> x, double tolerance, int maxIterations);
  /// out = K v, also on prescribed phyxels.
  void product(std::span<const Vec3> v, std::span<Vec3> out) { problem_->product(v, out); }
  [[nodiscard]] int iterations() const { return solver_.iterations(); }  ///< of the last solve
  void forget() { solver_.forget(); }

 private:
  Environment environment_;
  ImplicitStage stage_;
  Body *body_ = nullptr;
  std::optional<StageProblem> problem_;
  TangentSolver solver_;
  double residual_ = 0.0;
};

}  // namespace pointbased::detail
