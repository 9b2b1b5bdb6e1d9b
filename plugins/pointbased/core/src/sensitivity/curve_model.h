// SPDX-License-Identifier: Apache-2.0
// The force-displacement curve of a body for given moduli, with its derivatives. Private to the core.
#pragma once

#include <Eigen/Core>

#include "pointbased/equilibrium_sensitivity.h"
#include "pointbased/stiffness_fit.h"

namespace pointbased::detail {

/// What is measured at the points of a curve, and its derivatives with respect to the logarithms of the moduli.
struct CurvePrediction {
  Eigen::VectorXd values;       ///< [points] N or m
  Eigen::MatrixXd derivatives;  ///< [points][materials]
};

/// Static solutions along a curve. They are kept as starts of those with other moduli.
class CurveModel {
 public:
  /// Errors: conditions that do not say what is prescribed, or no watched point.
  /// @param prescribed  [points] m or N, >= 0, with at least one > 0
  [[nodiscard]] static Result<CurveModel> create(const StiffnessModel &model, std::span<const CurvePoint> curve,
                                                 const ParallelFor &parallelFor, const StopRequest *stop);

  [[nodiscard]] CurveControl control() const { return control_; }
  [[nodiscard]] bool hasGravity() const { return !gravity_.isZero(0.0); }
  [[nodiscard]] std::size_t materials() const { return moduli_.size(); }
  [[nodiscard]] double startModulus(std::size_t material) const { return moduli_[material]; }
  [[nodiscard]] std::size_t solutions() const { return solutions_; }
  /// Errors: no equilibrium, or what the sensitivities refuse.
  /// @param logFactors    [materials] of the moduli at the start
  /// @param wasSolved     called after each solution with the part that is done; false: cancelled
  [[nodiscard]] Result<CurvePrediction> predict(std::span<const double> logFactors,
                                                const std::function<bool(double)> &wasSolved);

 private:
  CurveModel() = default;
  [[nodiscard]] Result<void> prescribe(const StiffnessModel &model, RestState &rest, double largest);
  void placeNodes(std::span<const double> prescribed, double largest);
  /// Value and derivatives at one load factor.
  [[nodiscard]] Result<void> solveNode(std::size_t node, Eigen::Ref<Eigen::VectorXd> out);
  [[nodiscard]] Environment environment();

  ParallelFor parallelFor_;
  const StopRequest *stop_ = nullptr;
  StageClock clock_{stageNames()};
  std::unique_ptr<Body> body_;
  std::unique_ptr<NewtonSolver> newton_ = std::make_unique<NewtonSolver>();
  EquilibriumSensitivitySolver sensitivities_;
  Vec3 gravity_ = Vec3::Zero(), direction_ = Vec3::Zero();
  CurveControl control_ = CurveControl::support;
  std::size_t fix_ = 0;
  Interpolation watched_;
  std::vector<Vec3> objective_;                   ///< [phyxels] of the displacement of the watched point
  std::vector<double> moduli_;                    ///< Pa, at the start
  std::vector<double> nodes_;                     ///< load factors that are solved, ascending, the last one 1
  std::vector<std::vector<Vec3>> displacements_;  ///< [nodes], of the last solution; or empty
  Eigen::MatrixXd interpolation_;                 ///< [points][nodes]
  std::size_t solutions_ = 0;
};

}  // namespace pointbased::detail
