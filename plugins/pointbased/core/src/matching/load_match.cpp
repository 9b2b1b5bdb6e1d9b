// SPDX-License-Identifier: Apache-2.0
#include "matching/load_match.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pointbased::detail {
namespace {

constexpr double kFiner = 0.6;           // of the scale of the noise per iteration
constexpr double kNear = 4.0;            // of the noise: distances below which a further match starts with this noise
constexpr double kSmallChange = 0.1;     // of the noise: change of positions that ends the iterations
constexpr double kSettled = 0.01;        // relative change of the distance that ends them as well, three times in a row
constexpr double kLargestChange = 0.05;  // of the size, of the shape per iteration
constexpr double kReuse = 0.5;           // of the noise: change of shape for which derivatives are reused
constexpr double kReuseNear = 0.03;      // of the size: the same in a match that starts near the last one
constexpr double kLeastPart = 0.05;      // of a step
constexpr double kTurnSpread = 0.5, kShiftSpread = 0.2;     // rad, m: motions that are expected of a body at the start
constexpr double kLargestTurn = 0.1, kLargestShift = 0.02;  // rad, m, per iteration
constexpr std::size_t kTogether = 32;                       // phyxels per product of matrices

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
  double scale = terms_.spread();
  reuse_ = kReuse * settings_.noise;
  // Near the last solution, a larger assumed noise would move the estimate away from it.
  if (!loads.isZero(0.0) && scale < kNear) {
    scale = 1.0;
    reuse_ = std::max(reuse_, kReuseNear * size_);
  }
  terms_.weigh(scale > 1.0 ? RobustLoss::huber : RobustLoss::tukey, terms_.spread());
  double lastDistance = terms_.distance();
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
  rows.A = response_.sensitivities(terms_, reuse_, parallelFor_);
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
  double largest = std::min(1.0, kLargestChange * size_ / response_.size(change, parallelFor_));
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
  const Eigen::MatrixXd covariance = found.covariance();
  out.prior.resize(u_.size());
  out.posterior.resize(u_.size());
  parallelFor_((u_.size() + kTogether - 1) / kTogether, 1, [&](std::size_t begin, std::size_t end) {
    Eigen::MatrixXd here(3 * kTogether, loads.size());
    for (std::size_t block = begin; block < end; ++block) {
      const std::size_t first = block * kTogether, last = std::min(u_.size(), first + kTogether);
      std::array<double, kTogether> ofMotion{};
      here.setZero();
      for (std::size_t i = first; i < last; ++i) {
        auto rows = here.middleRows<3>(static_cast<Eigen::Index>(3 * (i - first)));
        for (Eigen::Index p = 0; p < loads.size(); ++p) rows.col(p) = response_.of(static_cast<std::size_t>(p), i);
        out.prior[i] = found.variance * rows.squaredNorm();
        if (found.motion.size() != 6) continue;
        const MatchSprings::Columns columns = terms_.motionColumns(rest_.positions[i] + u_[i]);
        rows += columns * found.motionByLoads;
        ofMotion[i - first] = (columns * found.motionCovariance).cwiseProduct(columns).sum();
      }
      const Eigen::MatrixXd spread = here * covariance;
      for (std::size_t i = first; i < last; ++i) {
        const auto row = static_cast<Eigen::Index>(3 * (i - first));
        const double ofLoads = spread.middleRows<3>(row).cwiseProduct(here.middleRows<3>(row)).sum();
        out.posterior[i] = ofMotion[i - first] + std::max(0.0, ofLoads);
      }
    }
  });
  return out;
}

}  // namespace pointbased::detail
