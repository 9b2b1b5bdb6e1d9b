// SPDX-License-Identifier: Apache-2.0
#include "matching/load_match.h"

#include <algorithm>
#include <cmath>

#include "stepping/implicit/stage_solution.h"

namespace pointbased::detail {
namespace {

constexpr double kLooseTolerance = 0.05;   // of the noise, of equilibria before the last one
constexpr int kMaxNewtonIterations = 20;   // then a smaller step is sooner
constexpr double kLinearTolerance = 1e-3;  // of responses to loads
constexpr int kMaxLinearIterations = 2000;
constexpr double kFiner = 0.6;           // of the scale of the noise per iteration
constexpr double kStale = 0.08;          // of the size: change of shape after which responses are computed anew
constexpr double kSlightlyStale = 0.02;  // at the end
constexpr double kSmallChange = 0.1;     // of the noise: change of positions that ends the iterations
constexpr double kSettled = 0.01;        // relative change of the distance that ends them as well, twice in a row
constexpr double kLargestChange = 0.05;  // of the size, of the shape per iteration: beyond, Newton's method is slow
constexpr double kLeastPart = 0.1;       // of a step
constexpr double kTurnSpread = 0.5, kShiftSpread = 0.2;     // rad, m: motions that are expected of a body at the start
constexpr double kLargestTurn = 0.1, kLargestShift = 0.02;  // rad, m, per iteration

double rootMeanSquare(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

LoadMatch::LoadMatch(Body &body, NewtonSolver &newton, const Environment &environment, const LoadPatterns &patterns,
                     MatchTerms &terms, const SurfaceMatchSettings &settings)
    : body_(body), newton_(newton), environment_(environment), patterns_(patterns), terms_(terms), settings_(settings) {
  stage_.end = 1.0;
  double volume = 0.0;
  for (const double v : body.rest().volumes) volume += v;
  size_ = std::cbrt(volume);
}

Result<void> LoadMatch::run(Eigen::VectorXd &loads, MatchMotion &motion) {
  if (auto done = respond(); !done) return done;
  double scale = terms_.spread(), lastDistance = terms_.distance();
  int still = 0;
  for (int k = 1; k <= settings_.maxIterations && !hasConverged_; ++k) {
    iterations_ = k;
    if (settings_.progress && !settings_.progress({k, settings_.maxIterations, terms_.distance(), u(), motion}))
      return tl::unexpected(std::string("cancelled"));
    const std::vector<Vec3> before = u();
    const MatchMotion motionBefore = motion;
    if (auto done = move(estimate(scale, loads), loads, motion); !done) return done;
    terms_.evaluate(u(), motion);
    terms_.weigh(scale > 1.0 ? RobustLoss::huber : RobustLoss::tukey, terms_.spread());
    double change = 0.0;
    const RestState &rest = body_.rest();
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Vec3 X = rest.origin + rest.positions[i];
      change += (motion.of(X + u()[i]) - motionBefore.of(X + before[i])).squaredNorm();
    }
    change = std::sqrt(change / static_cast<double>(before.size()));
    // Closest points jump between triangles, so that single positions keep changing a little.
    const double distance = terms_.distance();
    still = scale <= 1.0 && std::abs(distance - lastDistance) < kSettled * lastDistance ? still + 1 : 0;
    lastDistance = distance;
    const bool isEnd = scale <= 1.0 && (change < kSmallChange * settings_.noise || still >= 3);
    const double stale = rootMeanSquare(u(), respondedAt_);
    if (stale > (isEnd ? kSlightlyStale : kStale) * size_) {
      // Without them the earlier ones remain, and the iterations converge more slowly.
      isStable_ = respond().has_value();
      if (!isStable_ || isEnd) respondedAt_ = u();
    } else {
      hasConverged_ = isEnd;
    }
    // The first distances are those of shapes, not of noise.
    scale = std::max(1.0, std::min(kFiner * scale, terms_.spread()));
  }
  return {};
}

Result<void> LoadMatch::respond() {
  StageProblem problem(body_, environment_, stage_);
  const std::vector<Vec3> at = u();
  if (!problem.setState(at)) return tl::unexpected(std::string("the state of the body is not finite"));
  // The responses of a state before are near: only their residual is solved for.
  std::vector<std::vector<Vec3>> responses = responses_;
  responses.resize(patterns_.count(), std::vector<Vec3>(at.size(), Vec3::Zero()));
  std::vector<Vec3> forces(at.size()), product(at.size()), change(at.size());
  for (std::size_t p = 0; p < responses.size(); ++p) {
    patterns_.forces(p, forces);
    clearPrescribed(problem, forces);
    const double size = std::sqrt(dot(forces, forces));
    if (!responses_.empty()) {
      problem.product(responses[p], product);
      for (std::size_t i = 0; i < at.size(); ++i) forces[i] -= product[i];
      clearPrescribed(problem, forces);
    }
    const double residual = std::sqrt(dot(forces, forces));
    if (residual <= kLinearTolerance * size) continue;
    if (auto done = tangent_.solve(problem, forces, change, kLinearTolerance * size / residual, kMaxLinearIterations,
                                   Preconditioner::automatic, settings_.stop);
        !done)
      return done;
    for (std::size_t i = 0; i < at.size(); ++i) responses[p][i] += change[i];
  }
  responses_ = std::move(responses);
  respondedAt_ = at;
  return {};
}

LoadEstimate LoadMatch::estimate(double scale, const Eigen::VectorXd &loads) const {
  LinearMeasurements rows;
  terms_.linearise(scale, rows);
  rows.A.resize(rows.d.size(), loads.size());
  for (std::size_t p = 0; p < responses_.size(); ++p)
    terms_.observe(responses_[p], rows.A.col(static_cast<Eigen::Index>(p)));
  rows.d += rows.A * loads;
  Eigen::VectorXd prior(6);
  prior.head<3>().setConstant(1.0 / (kTurnSpread * kTurnSpread));
  prior.tail<3>().setConstant(1.0 / (kShiftSpread * kShiftSpread));
  return estimateLoads(rows, prior, settings_.noise, size_);
}

// Why there is none; empty: `at` is the equilibrium, and the state of the body.
std::string LoadMatch::equilibrium(const Eigen::VectorXd &loads, std::vector<Vec3> &at) {
  std::vector<Vec3> forces = patterns_.sum(loads);
  body_.swapExternalForces(forces);
  StageProblem problem(body_, environment_, stage_);
  NewtonSettings settings = newtonSettings(body_, environment_, true);
  settings.toleranceDisplacement = std::max(settings.toleranceDisplacement, kLooseTolerance * settings_.noise);
  settings.maxIterations = kMaxNewtonIterations;
  std::string why = failureOf(newton_.solve(problem, at, settings));
  if (why.empty()) (void)problem.setState(at);
  return why;
}

Result<void> LoadMatch::move(const LoadEstimate &to, Eigen::VectorXd &loads, MatchMotion &motion) {
  const std::vector<Vec3> from = u();
  const Eigen::VectorXd change = to.loads - loads;
  double largest = 1.0;
  MatchSprings::Motion step = MatchSprings::Motion::Zero();
  if (to.motion.size() == 6) {
    step = to.motion;
    largest = std::min({1.0, kLargestTurn / step.head<3>().norm(), kLargestShift / step.tail<3>().norm()});
  }
  std::vector<Vec3> shift(from.size(), Vec3::Zero());
  for (std::size_t p = 0; p < responses_.size(); ++p)
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] += change[static_cast<Eigen::Index>(p)] * responses_[p][i];
  const std::vector<Vec3> none(from.size(), Vec3::Zero());
  largest = std::min(largest, kLargestChange * size_ / rootMeanSquare(shift, none));
  std::string why;
  for (double part = largest; part >= kLeastPart * largest; part *= 0.5) {
    const Eigen::VectorXd next = loads + part * change;
    std::vector<Vec3> at = from;
    for (std::size_t i = 0; i < at.size(); ++i) at[i] += part * shift[i];
    why = equilibrium(next, at);
    if (!why.empty()) continue;
    loads = next;
    motion = terms_.moved(motion, part * step);
    return {};
  }
  u() = from;
  std::vector<Vec3> forces = patterns_.sum(loads);
  body_.swapExternalForces(forces);
  newton_.forget();
  return tl::unexpected("there is no equilibrium with the loads: " + why);
}

LoadMatch::Variances LoadMatch::variances(const Eigen::VectorXd &loads) {
  Variances out;
  if (!isStable_) return out;
  // Where the residuals are larger than the noise, so are the errors of the model.
  const LoadEstimate found = estimate(std::max(1.0, terms_.misfit()), loads);
  const auto patterns = static_cast<Eigen::Index>(responses_.size());
  Eigen::MatrixXd here(3, patterns);
  for (std::size_t i = 0; i < u().size(); ++i) {
    for (Eigen::Index p = 0; p < patterns; ++p) here.col(p) = responses_[static_cast<std::size_t>(p)][i];
    out.prior.push_back(found.priorVariance * here.squaredNorm());
    double ofMotion = 0.0;
    if (found.motion.size() == 6) {
      const MatchSprings::Columns columns = terms_.motionColumns(body_.rest().positions[i] + u()[i]);
      here += columns * found.motionByLoads;
      ofMotion = (columns * found.motionCovariance).cwiseProduct(columns).sum();
    }
    out.posterior.push_back(ofMotion + std::max(0.0, (here * found.covariance).cwiseProduct(here).sum()));
  }
  return out;
}

}  // namespace pointbased::detail
