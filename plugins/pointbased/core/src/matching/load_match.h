// SPDX-License-Identifier: Apache-2.0
// Loads and a rigid motion that bring a body to measurements. Private to the core.
#pragma once

#include "matching/load_estimate.h"
#include "matching/load_response.h"
#include "matching/match_terms.h"

namespace pointbased::detail {

/// Gauss-Newton iterations on the amplitudes of loads and the motion together. The loads are smooth, so that curvature
/// of the seen part has a cause, which deforms the unseen part as well.
class LoadMatch {
 public:
  /// All must outlive the object.
  /// @param displacements  [phyxels] m, of the body
  LoadMatch(std::vector<Vec3> &displacements, const RestState &rest, LoadResponse &response, MatchTerms &terms,
            const SurfaceMatchSettings &settings, const ParallelFor &parallelFor);

  /// @param loads, motion  start and result
  /// Errors: "cancelled".
  [[nodiscard]] Result<void> run(Eigen::VectorXd &loads, MatchMotion &motion);
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] bool hasConverged() const { return hasConverged_; }

  /// Variances of the moved position, sums of three components: after the measurement, and of the deformation before
  /// it.
  struct Variances {
    std::vector<double> posterior, prior;  ///< [phyxels] m²
  };
  [[nodiscard]] Variances variances(const Eigen::VectorXd &loads);

 private:
  [[nodiscard]] LoadEstimate estimate(double scale, LoadSize size, const Eigen::VectorXd &loads);
  [[nodiscard]] double objective(double scale, const Eigen::VectorXd &loads, double variance) const;
  // Part of the step that was taken.
  double move(const LoadEstimate &to, double scale, Eigen::VectorXd &loads, MatchMotion &motion);

  std::vector<Vec3> &u_;
  const RestState &rest_;
  LoadResponse &response_;
  MatchTerms &terms_;
  const SurfaceMatchSettings &settings_;
  const ParallelFor &parallelFor_;
  double size_ = 0.0;   // m, of the body
  double reuse_ = 0.0;  // m, change of shape for which derivatives are reused
  int iterations_ = 0;
  bool hasConverged_ = false;
};

}  // namespace pointbased::detail
