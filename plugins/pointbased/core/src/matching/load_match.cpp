// SPDX-License-Identifier: Apache-2.0
#include "matching/load_match.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
namespace {

constexpr double kFiner = 0.6;           // of the scale of the noise per iteration
constexpr double kSmallChange = 0.1;     // of the noise: change of positions that ends the iterations
constexpr double kSettled = 0.01;        // relative change of the distance that ends them as well, three times in a row
constexpr double kLargestChange = 0.05;  // of the size, of the shape per iteration
constexpr double kSameShape = 0.5;       // of the noise: change of shape that leaves the derivatives
constexpr double kLeastPart = 0.05;      // of a step
constexpr double kTurnSpread = 0.5, kShiftSpread = 0.2;     // rad, m: motions that are expected of a body at the start
constexpr double kLargestTurn = 0.1, kLargestShift = 0.02;  // rad, m, per iteration

}  // namespace

LoadMatch::LoadMatch(std::vector<Vec3> &displacements, const RestState &rest, LoadResponse &response, MatchTerms &terms,
                     const SurfaceMatchSettings &settings, const ParallelFor &parallelFor)
    : u_(displacements), rest_(rest), response_(response), terms_(terms), settings_(settings),
      parallelFor_(parallelFor) {
  double volume = 0.0;
  for (const double v : rest.volumes) volume += v;
  size_ = std::cbrt(volume);
}

Result<void> LoadMatch::run(Eigen::VectorXd &loads, MatchMotion &motion) {
  // Derivatives of a match before would make the result depend on it.
  response_.forgetDerivatives();
  response_.deform(loads, u_, parallelFor_);
  terms_.evaluate(u_, motion);
  terms_.weigh(RobustLoss::huber, terms_.spread());
  double scale = terms_.spread(), lastDistance = terms_.distance();
  int still = 0;
  for (int k = 1; k <= settings_.maxIterations && !hasConverged_; ++k) {
    iterations_ = k;
    throwIfStopRequested(settings_.stop);
    if (settings_.progress && !settings_.progress({k, settings_.maxIterations, terms_.distance(), u_, motion}))
      return tl::unexpected(std::string("cancelled"));
    const std::vector<Vec3> before = u_;
    const MatchMotion motionBefore = motion;
    const LoadSize size = scale > 1.0 ? LoadSize::geometricMean : LoadSize::mean;
    const double part = move(estimate(scale, size, loads), scale, loads, motion);
    terms_.weigh(scale > 1.0 ? RobustLoss::huber : RobustLoss::tukey, terms_.spread());
    double change = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Vec3 X = rest_.origin + rest_.positions[i];
      change += (motion.of(X + u_[i]) - motionBefore.of(X + before[i])).squaredNorm();
    }
    change = std::sqrt(change / static_cast<double>(before.size()));
    // Closest points jump between triangles, so that single positions keep changing a little.
    const double distance = terms_.distance();
    still = scale <= 1.0 && std::abs(distance - lastDistance) < kSettled * lastDistance ? still + 1 : 0;
    lastDistance = distance;
    hasConverged_ = scale <= 1.0 && (change < kSmallChange * settings_.noise || still >= 3);
    // The first distances are those of shapes, not of noise.
    scale = std::max(1.0, std::min(std::pow(kFiner, part) * scale, terms_.spread()));
  }
  return {};
}

LoadEstimate LoadMatch::estimate(double scale, LoadSize size, const Eigen::VectorXd &loads) {
  LinearMeasurements rows;
  terms_.linearise(scale, rows);
  rows.A = response_.sensitivities(terms_, kSameShape * settings_.noise, parallelFor_);
  rows.d += rows.A * loads;
  Eigen::VectorXd prior(6);
  prior.head<3>().setConstant(1.0 / (kTurnSpread * kTurnSpread));
  prior.tail<3>().setConstant(1.0 / (kShiftSpread * kShiftSpread));
  return estimateLoads(rows, prior, settings_.noise, size_, size);
}

// Twice the negative logarithm of the posterior density for loads of a given variance, without constants.
double LoadMatch::objective(double scale, const Eigen::VectorXd &loads, double variance) const {
  LinearMeasurements rows;
  terms_.linearise(scale, rows);
  return loads.squaredNorm() / variance + rows.d.cwiseAbs2().dot(rows.weights);
}

double LoadMatch::move(const LoadEstimate &to, double scale, Eigen::VectorXd &loads, MatchMotion &motion) {
  const Eigen::VectorXd loadsBefore = loads, change = to.loads - loads;
  const MatchMotion motionBefore = motion;
  double largest = std::min(1.0, kLargestChange * size_ / response_.size(change));
  MatchSprings::Motion step = MatchSprings::Motion::Zero();
  if (to.motion.size() == 6) {
    step = to.motion;
    largest = std::min({largest, kLargestTurn / step.head<3>().norm(), kLargestShift / step.tail<3>().norm()});
  }
  const double before = objective(scale, loads, to.variance);
  for (double part = largest;; part *= 0.5) {
    loads = loadsBefore + part * change;
    motion = terms_.moved(motionBefore, part * step);
    response_.deform(loads, u_, parallelFor_);
    terms_.evaluate(u_, motion);
    if (part < kLeastPart * largest || objective(scale, loads, to.variance) < before) return part;
  }
}

LoadMatch::Variances LoadMatch::variances(const Eigen::VectorXd &loads) {
  Variances out;
  // Where the residuals are larger than the noise, so are the errors of the model.
  const LoadEstimate found = estimate(std::max(1.0, terms_.misfit()), LoadSize::mean, loads);
  Eigen::MatrixXd here(3, loads.size());
  for (std::size_t i = 0; i < u_.size(); ++i) {
    for (Eigen::Index p = 0; p < loads.size(); ++p) here.col(p) = response_.of(static_cast<std::size_t>(p), i);
    out.prior.push_back(found.variance * here.squaredNorm());
    double ofMotion = 0.0;
    if (found.motion.size() == 6) {
      const MatchSprings::Columns columns = terms_.motionColumns(rest_.positions[i] + u_[i]);
      here += columns * found.motionByLoads;
      ofMotion = (columns * found.motionCovariance).cwiseProduct(columns).sum();
    }
    out.posterior.push_back(ofMotion + std::max(0.0, (here * found.covariance).cwiseProduct(here).sum()));
  }
  return out;
}

}  // namespace pointbased::detail
