// SPDX-License-Identifier: Apache-2.0
#include "matching/load_estimate.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pointbased::detail {
namespace {

constexpr double kRatio = 1.5;  // of neighbouring values of s

// Values of s² and their posterior probabilities.
struct Scales {
  std::vector<double> squares, probabilities;
};

Scales scalesOf(const Eigen::VectorXd &lambda, const Eigen::VectorXd &b, double least, double most) {
  Scales out;
  double best = -std::numeric_limits<double>::infinity();
  for (double s = least; s <= most * kRatio; s *= kRatio) {
    const Eigen::ArrayXd one = 1.0 + s * s * lambda.array();
    const double evidence = 0.5 * (s * s * b.array().square() / one - one.log()).sum();
    out.squares.push_back(s * s);
    out.probabilities.push_back(evidence);
    best = std::max(best, evidence);
  }
  double sum = 0.0;
  for (double &p : out.probabilities) sum += p = std::exp(p - best);
  for (double &p : out.probabilities) p /= sum;
  return out;
}

}  // namespace

LoadEstimate estimateLoads(const LinearMeasurements &from, const Eigen::VectorXd &motionPrior, double smallest,
                           double largest) {
  const Eigen::MatrixXd WA = from.weights.asDiagonal() * from.A;
  Eigen::MatrixXd normal = from.A.transpose() * WA;
  Eigen::VectorXd right = WA.transpose() * from.d;
  LoadEstimate out;
  Eigen::VectorXd alone;  // motion without loads
  if (from.C.cols() > 0) {
    Eigen::MatrixXd own = from.C.transpose() * from.weights.asDiagonal() * from.C;
    own.diagonal() += motionPrior;
    const Eigen::LDLT<Eigen::MatrixXd> solver(own);
    const Eigen::MatrixXd mixed = from.C.transpose() * WA;
    const Eigen::VectorXd rightOfMotion = from.C.transpose() * from.weights.asDiagonal() * from.d;
    out.motionByLoads = -solver.solve(mixed);
    out.motionCovariance = solver.solve(Eigen::MatrixXd::Identity(own.rows(), own.cols()));
    alone = solver.solve(rightOfMotion);
    normal += mixed.transpose() * out.motionByLoads;
    right -= mixed.transpose() * alone;
  }
  normal = 0.5 * (normal + normal.transpose()).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(normal);
  const Eigen::VectorXd lambda = modes.eigenvalues().cwiseMax(0.0);
  const Eigen::MatrixXd &V = modes.eigenvectors();
  const Eigen::VectorXd b = V.transpose() * right;
  // Rows without a weight, such as outliers, do not count.
  const double total = from.weights.sum();
  const double unit = total > 0.0 ? std::sqrt(WA.cwiseProduct(from.A).sum() / total) : 0.0;
  const double least = unit > 0.0 ? smallest / unit : 1.0, most = unit > 0.0 ? largest / unit : 1.0;
  const Scales scales = scalesOf(lambda, b, least, std::max(least, most));

  const Eigen::Index n = lambda.size();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n), variance = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::VectorXd> means;
  for (std::size_t k = 0; k < scales.squares.size(); ++k) {
    const double square = scales.squares[k], p = scales.probabilities[k];
    const Eigen::VectorXd own = square / (1.0 + square * lambda.array());
    means.emplace_back(own.cwiseProduct(b));
    mean += p * means.back();
    variance += p * own;
    out.priorVariance += p * square;
  }
  Eigen::MatrixXd covariance = variance.asDiagonal();
  for (std::size_t k = 0; k < means.size(); ++k)
    covariance += scales.probabilities[k] * (means[k] - mean) * (means[k] - mean).transpose();
  out.loads = V * mean;
  out.covariance = V * covariance * V.transpose();
  if (from.C.cols() > 0) out.motion = alone + out.motionByLoads * out.loads;
  return out;
}

}  // namespace pointbased::detail
