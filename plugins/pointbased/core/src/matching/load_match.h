// SPDX-License-Identifier: Apache-2.0
// Loads and a rigid motion that bring a body to measurements. Private to the core.
#pragma once

#include "matching/load_estimate.h"
#include "matching/load_patterns.h"
#include "matching/match_terms.h"
#include "pointbased/integrators.h"
#include "sensitivity/equilibrium_tangent.h"

namespace pointbased::detail {

/// Gauss-Newton iterations on the amplitudes of loads and the motion together. The loads are smooth, so that curvature
/// of the seen part has a cause, which deforms the unseen part as well. Every iterate is an equilibrium.
class LoadMatch {
 public:
  /// All must outlive the object. `terms` are evaluated at the state of the body and weighted.
  LoadMatch(Body &body, NewtonSolver &newton, const Environment &environment, const LoadPatterns &patterns,
            MatchTerms &terms, const SurfaceMatchSettings &settings);

  /// @param loads, motion  start and result; the body is in equilibrium with the loads
  /// Errors: "cancelled"; a tangent that is not positive definite; no equilibrium. The body and the arguments are then
  /// those of the last equilibrium.
  [[nodiscard]] Result<void> run(Eigen::VectorXd &loads, MatchMotion &motion);
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] bool hasConverged() const { return hasConverged_; }

  /// Variances of the moved position, sums of three components: after the measurement, and of the deformation before
  /// it. Empty: the equilibrium is not stable.
  struct Variances {
    std::vector<double> posterior, prior;  ///< [phyxels] m²
  };
  [[nodiscard]] Variances variances(const Eigen::VectorXd &loads);

 private:
  [[nodiscard]] Result<void> respond();
  [[nodiscard]] LoadEstimate estimate(double scale, const Eigen::VectorXd &loads) const;
  [[nodiscard]] Result<void> move(const LoadEstimate &to, Eigen::VectorXd &loads, MatchMotion &motion);
  [[nodiscard]] std::string equilibrium(const Eigen::VectorXd &loads, std::vector<Vec3> &u);
  [[nodiscard]] std::vector<Vec3> &u() { return body_.state().displacements; }

  Body &body_;
  NewtonSolver &newton_;
  const Environment &environment_;
  const LoadPatterns &patterns_;
  MatchTerms &terms_;
  const SurfaceMatchSettings &settings_;
  ImplicitStage stage_;
  TangentSolver tangent_;
  std::vector<std::vector<Vec3>> responses_;  // [patterns][phyxels] m/Pa
  std::vector<Vec3> respondedAt_;             // m, displacements for which they are
  double size_ = 0.0;                         // m, of the body
  int iterations_ = 0;
  bool hasConverged_ = false, isStable_ = true;
};

}  // namespace pointbased::detail
