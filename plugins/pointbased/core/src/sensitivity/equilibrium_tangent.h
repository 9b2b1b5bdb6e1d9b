// SPDX-License-Identifier: Apache-2.0
// Linear solves with the tangent of a body in static equilibrium. Private to the core.
#pragma once

#include <optional>

#include "solvers/conjugate_gradients.h"
#include "solvers/preconditioner.h"
#include "stepping/implicit/stage_problem.h"

namespace pointbased::detail {

/// The tangent K of the static residual at the present displacements of a body, without contact. One thread at a time.
class EquilibriumTangent {
 public:
  /// Refers to the body until the next call; environment and body must outlive the solves. The state is unchanged.
  /// Errors: what EquilibriumSensitivitySolver::solve() refuses, except for the residual.
  [[nodiscard]] Result<void> linearise(Body &body, const Environment &environment, double loadFactor);
  /// |r| of free phyxels over |internal forces|; 0 for a body without forces.
  [[nodiscard]] double residual() const { return residual_; }
  /// x = K^-1 b on free phyxels, 0 on prescribed ones; b on prescribed phyxels is ignored.
  /// @param tolerance  relative, in the norm of the preconditioner
  /// Errors: a tangent that is not positive definite; no convergence within maxIterations.
  [[nodiscard]] Result<void> solve(std::span<const Vec3> b, std::span<Vec3> x, double tolerance, int maxIterations);
  /// out = K v, also on prescribed phyxels.
  void product(std::span<const Vec3> v, std::span<Vec3> out) { problem_->product(v, out); }
  [[nodiscard]] int iterations() const { return iterations_; }  ///< of conjugate gradients, of the last solve
  void forget() { keeper_.forget(); }

 private:
  void clearPrescribed(std::span<Vec3> v) const;

  Environment environment_;
  ImplicitStage stage_;
  Body *body_ = nullptr;
  std::optional<StageProblem> problem_;
  PreconditionerOfParts keeper_;
  ConjugateGradients linear_;
  std::vector<Vec3> right_;
  double residual_ = 0.0;
  int iterations_ = 0;
};

}  // namespace pointbased::detail
