// SPDX-License-Identifier: Apache-2.0
// Bayesian estimate of loads from measurements that depend linearly on them. Private to the core.
#pragma once

#include <Eigen/Core>

namespace pointbased::detail {

/// Measurements d = A q + C m + noise: q amplitudes of loads, m a motion.
struct LinearMeasurements {
  Eigen::MatrixXd A;        ///< [rows, loads] m/Pa
  Eigen::MatrixXd C;        ///< [rows, 6], or [rows, 0]: the motion is known
  Eigen::VectorXd d;        ///< [rows] m
  Eigen::VectorXd weights;  ///< [rows] 1/m², inverse variances
};

/// Mean of s² by its probability. The geometric mean is smaller: a cautious choice while the shape is far from the
/// measured one.
enum class LoadSize { mean, geometricMean };

struct LoadEstimate {
  Eigen::VectorXd loads;             ///< Pa
  Eigen::VectorXd motion;            ///< [6], or empty
  Eigen::MatrixXd eigenvectors;      ///< [loads, loads], of the normal matrix
  Eigen::MatrixXd eigenCovariance;   ///< of the loads in this basis, Pa²
  Eigen::MatrixXd motionByLoads;     ///< [6, loads]: change of the motion with the loads
  Eigen::MatrixXd motionCovariance;  ///< [6, 6], for given loads
  double variance = 0.0;             ///< Pa², of a load before the measurement, s²

  [[nodiscard]] Eigen::MatrixXd covariance() const {  ///< of the loads, Pa²
    return eigenvectors * eigenCovariance * eigenvectors.transpose();
  }
};

/// Normal prior q ~ N(0, s² I), with s unknown between bounds and its logarithm uniform. Loads and motion are those
/// for a mean of s² by the marginal likelihood, and covariances are means over s by it:
///
///     ln p(d | s) = -½ Σ ln(1 + s² λ_j) + ½ Σ s² b_j² / (1 + s² λ_j) + const
///
/// with the eigenvalues λ of the normal matrix from which the motion was eliminated, and b its right side.
/// @param smallest, largest  m: root mean square of A q over the rows for the bounds of s
/// @param motionPrior  [6] inverse variances
/// @source  MacKay, Bayesian interpolation, Neural Computation 4, 1992 (evidence); Tarantola, Inverse Problem Theory,
///          2005, ch. 3
[[nodiscard]] LoadEstimate estimateLoads(const LinearMeasurements &from, const Eigen::VectorXd &motionPrior,
                                         double smallest, double largest, LoadSize size);

}  // namespace pointbased::detail
