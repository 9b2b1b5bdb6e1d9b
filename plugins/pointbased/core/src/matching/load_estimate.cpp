// SPDX-License-Identifier: Apache-2.0
#include "matching/load_estimate.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
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
                           double largest, LoadSize size) {
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
  const auto posterior = [&](double square) {
    return Eigen::VectorXd((square / (1.0 + square * lambda.array())).matrix());  // variances of the modes
  };
  double logarithm = 0.0;
  for (std::size_t k = 0; k < scales.squares.size(); ++k) {
    out.variance += scales.probabilities[k] * scales.squares[k];
    logarithm += scales.probabilities[k] * std::log(scales.squares[k]);
  }
  if (size == LoadSize::geometricMean) out.variance = std::exp(logarithm);
  const Eigen::VectorXd mean = posterior(out.variance).cwiseProduct(b);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t k = 0; k < scales.squares.size(); ++k) {
    const Eigen::VectorXd own = posterior(scales.squares[k]), off = own.cwiseProduct(b) - mean;
    covariance += scales.probabilities[k] * off * off.transpose();
    covariance.diagonal() += scales.probabilities[k] * own;
  }
  out.loads = V * mean;
  out.eigenvectors = V;
  out.eigenCovariance = std::move(covariance);
  if (from.C.cols() > 0) out.motion = alone + out.motionByLoads * out.loads;
  return out;
}

}  // namespace pointbased::detail
