// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surface_match.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "matching/load_match.h"
#include "matching/match_springs.h"
#include "matching/match_terms.h"
#include "pointbased/integrators.h"
#include "sensitivity/equilibrium_tangent.h"
#include "stepping/implicit/stage_solution.h"

namespace pointbased {
namespace {

using detail::MatchPotential;
using detail::MatchSprings;
using detail::MatchTerms;
using detail::number;
using detail::RobustLoss;
using Vector6 = MatchSprings::Motion;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kLooseTolerance = 1e-3;                           // spacings, of solutions before the last one
constexpr double kMotionTolerance = 1e-4, kErrorTolerance = 1e-2;  // of linear solves
constexpr int kMaxLinearIterations = 2000;
constexpr int kRigidIterations = 60;
constexpr double kSmallChange = 0.1;     // of the noise: change of the distances that ends the match
constexpr double kSettled = 0.01;        // relative change of the distance that ends it as well, twice in a row
constexpr double kAsNoise = 1.1;         // of the noise: distances that are explained
constexpr double kFirstStiffness = 0.1;  // of all springs together, over E times the size of the body
constexpr double kLastStiffness = 200.0, kStiffer = 3.0;
constexpr double kNear = 2.0, kALittleStiffer = 1.6;        // of the noise: distances from which on it increases slowly
constexpr double kTurnSpread = 0.5, kShiftSpread = 0.2;     // rad, m: motions that are expected of a body at the start
constexpr double kLargestTurn = 0.1, kLargestShift = 0.02;  // rad, m, per iteration
constexpr std::size_t kSites = 14;                          // at which expected errors are computed
constexpr double kUnknown = 0.7;  // of the spread without measurements, beyond which nothing is known

Constitution elasticOf(Constitution constitution) {
  for (Material &material : constitution.materials) {
    material.prony = {};
    material.plastic = {};
    material.viscosity = 0.0;
  }
  return constitution;
}

template <class T>
std::string indexed(const char *what, std::size_t i, const char *quantity, const T &value, const char *accepted) {
  return std::string(what) + " " + std::to_string(i) + ": " + quantity + " " + value + ", " + accepted;
}

std::string problemOf(std::span<const MatchPoint> points, std::span<const MatchLandmark> landmarks,
                      const SurfaceMatchSettings &settings) {
  if (!(settings.noise > 0.0) || !std::isfinite(settings.noise))
    return "noise " + number(settings.noise) + " m, must be finite and > 0";
  if (!(settings.largestAngle_deg >= 0.0 && settings.largestAngle_deg <= 180.0))
    return "largest angle " + number(settings.largestAngle_deg) + "°, must be 0 … 180";
  if (settings.maxIterations < 1) return "iterations " + std::to_string(settings.maxIterations) + ", must be >= 1";
  const Mat3 &R = settings.start.rotation;
  if (!R.allFinite() || !settings.start.translation.allFinite() ||
      !(R * R.transpose()).isApprox(Mat3::Identity(), 1e-6) || R.determinant() < 0.0)
    return "the motion at the start is not a finite rotation and translation";
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].position.allFinite()) return indexed("point", i, "position", "is not finite", "in m");
    const double length = points[i].normal.norm();
    if (length != 0.0 && !(std::abs(length - 1.0) < 1e-3))
      return indexed("point", i, "normal of length", number(length), "must be 1, or 0 if it is not known");
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!landmarks[i].position.allFinite() || !landmarks[i].reference.allFinite())
      return indexed("landmark", i, "position", "is not finite", "in m");
    if (!(landmarks[i].noise >= 0.0) || !std::isfinite(landmarks[i].noise))
      return indexed("landmark", i, "noise", number(landmarks[i].noise), "must be finite and >= 0, in m");
  }
  if (points.size() + landmarks.size() < 3)
    return std::to_string(points.size()) + " points and " + std::to_string(landmarks.size()) +
           " landmarks; together at least 3 are required";
  return {};
}

}  // namespace

struct SurfaceMatch::Impl {
  ParallelFor parallelFor;
  std::unique_ptr<Body> body;
  Interpolation skin;  // binding of its vertices
  StageClock clock{stageNames()};
  NewtonSolver newton;
  detail::TangentSolver tangent;
  double stiffness = 0.0;  // N/m, of the springs of the last match; 0: none
  std::optional<detail::LoadPatterns> patterns;
  Eigen::VectorXd loads;  // Pa, amplitudes of the patterns

  [[nodiscard]] Environment environment(const StopRequest *stop) {
    Environment out;
    out.parallelFor = &parallelFor;
    out.clock = &clock;
    out.stop = stop;
    return out;
  }
  void setLoads(const Eigen::VectorXd &to) {
    loads = to;
    std::vector<Vec3> forces;
    if (!loads.isZero(0.0)) forces = patterns->sum(loads);
    body->swapExternalForces(forces);
  }
  [[nodiscard]] Result<void> findEquilibrium(const StopRequest *stop) {
    body->quasiStatic = true;
    const std::string why = quasiStaticStep(*body, newton, environment(stop), 0.0, 1.0).failure;
    if (why.empty()) return {};
    return tl::unexpected("body '" + body->name() + "' has no equilibrium without further forces: " + why);
  }
};

namespace {

// One match: the iterations, on the state of the object.
template <class Impl>
class Iterations {
 public:
  Iterations(Impl &of, std::span<const MatchPoint> points, std::span<const MatchLandmark> landmarks,
             const SurfaceMatchSettings &settings)
      : of_(of), settings_(settings), points_(points.size()), all_(points.size() + landmarks.size()),
        environment_(of.environment(settings.stop)),
        terms_(of.body->rest(), of.skin, points, landmarks, settings, of.parallelFor), motion_(settings.start) {
    stage_.end = 1.0;
    double volume = 0.0, modulus = 0.0;
    for (const double v : of.body->rest().volumes) volume += v;
    for (const Material &m : of.body->constitution().materials) modulus = std::max(modulus, m.youngsModulus);
    unit_ = modulus * std::cbrt(volume) / static_cast<double>(all_);
  }

  Result<SurfaceMatchResult> run() {
    terms_.evaluate(u(), motion_);
    if (!terms_.sees())
      return tl::unexpected(
          std::string("no part of the skin faces any of the points; their normals may point inwards"));
    weigh();
    out_.distanceAtStart = terms_.distance();
    const bool isFirst = of_.stiffness == 0.0;
    if (!settings_.isMotionKnown && isFirst) alignRigidly();
    out_.distanceRigid = terms_.distance();
    out_.rigid = motion_;
    if (auto done = fitLoads(); !done) return tl::unexpected(done.error());
    if (isExplained_) return finish();
    stiffness_ = isFirst ? kFirstStiffness * unit_ : of_.stiffness;
    isStiff_ = !isFirst;
    out_.hasConverged = false;
    for (int k = 1; k <= settings_.maxIterations && !out_.hasConverged; ++k) {
      ++out_.iterations;
      if (settings_.progress && !settings_.progress({k, settings_.maxIterations, terms_.distance(), u(), motion_}))
        return tl::unexpected(std::string("cancelled"));
      if (auto done = iterate(); !done) return tl::unexpected(done.error());
    }
    of_.stiffness = stiffness_;
    return finish();
  }

 private:
  [[nodiscard]] std::vector<Vec3> &u() { return of_.body->state().displacements; }
  void weigh() { terms_.weigh(loss_, terms_.spread()); }

  // Smooth loads and the motion. Springs follow only where these do not explain the measurement.
  Result<void> fitLoads() {
    const std::vector<Vec3> before = u();
    const Eigen::VectorXd loadsBefore = of_.loads;
    const MatchMotion motionBefore = motion_;
    detail::LoadMatch loads(*of_.body, of_.newton, environment_, *of_.patterns, terms_, settings_);
    if (auto done = loads.run(of_.loads, motion_); !done) {
      if (done.error() == "cancelled") return done;
      u() = before;
      of_.setLoads(loadsBefore);
      motion_ = motionBefore;
      of_.newton.forget();
      terms_.evaluate(u(), motion_);
      weigh();
      return {};
    }
    out_.iterations = loads.iterations();
    out_.hasConverged = loads.hasConverged();
    loss_ = RobustLoss::tukey;
    hasLoads_ = true;
    isExplained_ = terms_.misfit() <= kAsNoise;
    if (settings_.findsExpectedErrors) variances_ = loads.variances(of_.loads);
    return {};
  }
  [[nodiscard]] bool isMotionKnown() const { return settings_.isMotionKnown || hasLoads_; }

  static void addPrior(Matrix6 &hessian, double stiffness, double noise) {
    const double scale = stiffness * noise * noise;
    hessian.diagonal().head<3>().array() += scale / (kTurnSpread * kTurnSpread);
    hessian.diagonal().tail<3>().array() += scale / (kShiftSpread * kShiftSpread);
  }

  // Iterative closest points of the body as it is.
  void alignRigidly() {
    const std::vector<Vec3> none(u().size(), Vec3::Zero());
    std::array<std::vector<Vec3>, 6> unused;
    for (int k = 0; k < kRigidIterations; ++k) {
      terms_.springs(1.0, springs_);
      Vector6 gradient;
      Matrix6 hessian;
      springs_.ofMotion(none, gradient, hessian, unused);
      addPrior(hessian, 1.0, settings_.noise);
      const Vector6 step = -hessian.ldlt().solve(gradient);
      motion_ = terms_.moved(motion_, step);
      terms_.evaluate(u(), motion_);
      weigh();
      if (sizeOf(step) < 0.2 * kSmallChange * settings_.noise) break;
    }
  }
  // m, of the motion of the body by a step.
  [[nodiscard]] double sizeOf(const Vector6 &step) const {
    return step.tail<3>().norm() + 0.05 * step.head<3>().norm();
  }

  [[nodiscard]] NewtonSettings newtonSettings(double tolerance) {
    NewtonSettings out = detail::newtonSettings(*of_.body, environment_, true);
    if (tolerance > 0.0) out.toleranceDisplacement = tolerance;
    return out;
  }

  // Equilibrium with the springs; false: there is none.
  [[nodiscard]] Result<void> solve(MatchPotential &potential, double tolerance) {
    std::vector<Vec3> at = u();
    const NewtonResult solved = of_.newton.solve(potential, at, newtonSettings(tolerance));
    if (std::string why = detail::failureOf(solved); !why.empty())
      return tl::unexpected("the equilibrium of the match was not found: " + why);
    (void)potential.setState(at);
    return {};
  }

  // One round of closest points.
  Result<void> iterate() {
    terms_.springs(stiffness_, springs_);
    from_ = u();
    const MatchMotion before = motion_;
    {
      MatchPotential potential(*of_.body, environment_, stage_, springs_, from_);
      if (auto done = solve(potential, kLooseTolerance * of_.body->rest().spacing); !done) return done;
      if (!isMotionKnown())
        if (auto done = moveBody(potential); !done) return done;
    }
    terms_.evaluate(u(), motion_);
    weigh();
    const double distance = terms_.distance();
    const double change = largestChange(before);
    if (!isStiff_) {
      const double misfit = terms_.misfit();
      if (misfit <= kAsNoise || stiffness_ >= kLastStiffness * unit_)
        isStiff_ = true;
      else
        stiffness_ *= misfit > kNear ? kStiffer : kALittleStiffer;
      return {};
    }
    if (loss_ == RobustLoss::huber) {
      loss_ = RobustLoss::tukey;
      weigh();
      return {};
    }
    // Closest points jump between triangles, so that single positions keep changing a little.
    still_ = std::abs(distance - lastDistance_) < kSettled * lastDistance_ ? still_ + 1 : 0;
    lastDistance_ = distance;
    out_.hasConverged = change < kSmallChange * settings_.noise || still_ >= 2;
    return {};
  }

  // m, root mean square over the phyxels.
  [[nodiscard]] double largestChange(const MatchMotion &before) {
    double sum = 0.0;
    const RestState &rest = of_.body->rest();
    for (std::size_t i = 0; i < from_.size(); ++i) {
      const Vec3 X = rest.origin + rest.positions[i];
      sum += (motion_.of(X + u()[i]) - before.of(X + from_[i])).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(from_.size()));
  }

  // Newton step of the motion: the energy of the equilibrium as a function of it.
  Result<void> moveBody(MatchPotential &potential) {
    Vector6 gradient;
    Matrix6 hessian;
    // Under compression the tangent may be indefinite between equilibria; the motion is then updated in the next
    // iteration.
    if (auto done = reducedHessian(potential, gradient, hessian); !done) return {};
    Vector6 step = -hessian.ldlt().solve(gradient);
    if (!step.allFinite() || gradient.dot(step) > 0.0) return {};
    const double turn = step.head<3>().norm(), shift = step.tail<3>().norm();
    step *= std::min({1.0, kLargestTurn / turn, kLargestShift / shift});
    motion_ = terms_.moved(motion_, step);
    // The body responds to the motion.
    for (Eigen::Index a = 0; a < 6; ++a)
      for (std::size_t i = 0; i < u().size(); ++i) u()[i] -= step[a] * responses_[static_cast<std::size_t>(a)][i];
    return {};
  }

  // Schur complement of the motion, and K^-1 d²U/(du dm) as responses_.
  Result<void> reducedHessian(MatchPotential &potential, Vector6 &gradient, Matrix6 &hessian) {
    std::array<std::vector<Vec3>, 6> mixed;
    springs_.ofMotion(potential.since(), gradient, hessian, mixed);
    for (std::size_t a = 0; a < 6; ++a) {
      responses_[a].resize(u().size());
      if (auto done = of_.tangent.solve(potential, mixed[a], responses_[a], kMotionTolerance, kMaxLinearIterations,
                                        Preconditioner::automatic, settings_.stop);
          !done)
        return done;
    }
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b)
        hessian(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) -= detail::dot(mixed[a], responses_[b]);
    hessian = 0.5 * (hessian + hessian.transpose()).eval();
    addPrior(hessian, stiffness_, settings_.noise);
    return {};
  }

  Result<SurfaceMatchResult> finish() {
    terms_.springs(stiffness_, springs_);
    from_ = u();
    MatchPotential potential(*of_.body, environment_, stage_, springs_, from_);
    if (auto done = solve(potential, 0.0); !done) return tl::unexpected(done.error());
    out_.forces.assign(u().size(), Vec3::Zero());
    springs_.addForces(potential.since(), out_.forces);
    const std::span<const Vec3> loads = of_.body->externalForces();
    for (std::size_t i = 0; i < loads.size(); ++i) out_.forces[i] += loads[i];
    out_.displacements = u();
    if (settings_.findsExpectedErrors) findExpectedErrors(potential);
    terms_.evaluate(u(), motion_);
    weigh();
    out_.distance = terms_.distance();
    out_.motion = motion_;
    out_.stiffness = stiffness_;
    const Vec3 &origin = of_.body->rest().origin;
    for (std::size_t i = 0; i < points_; ++i) {
      out_.closest.push_back(motion_.of(origin + terms_.closest()[i].position));
      out_.distances.push_back(terms_.distanceOf(i));
      out_.weights.push_back(terms_.weights()[i]);
      if (terms_.weights()[i] > 0.5) out_.usedPart += 1.0 / static_cast<double>(points_);
    }
    for (std::size_t i = points_; i < all_; ++i) out_.landmarkErrors.push_back(terms_.distanceOf(i));
    return std::move(out_);
  }

  // Material points that are far from each other. Phyxels would not do: corners of slivers fluctuate alone.
  [[nodiscard]] Interpolation sites() const {
    const RestState &rest = of_.body->rest();
    const std::vector<Vec3> &all = rest.pointCentres.empty() ? rest.positions : rest.pointCentres;
    std::vector<double> squared(all.size(), std::numeric_limits<double>::infinity());
    std::vector<Vec3> out;
    while (out.size() < std::min(kSites, all.size())) {
      const auto next = static_cast<std::size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
      out.push_back(all[next]);
      for (std::size_t i = 0; i < all.size(); ++i)
        squared[i] = std::min(squared[i], (all[i] - all[next]).squaredNorm());
    }
    return rest.bind(out, {});
  }
  // [sites] of a field of the phyxels.
  [[nodiscard]] static Vec3 valueAt(const Interpolation &at, std::size_t k, std::span<const Vec3> field) {
    Vec3 sum = Vec3::Zero();
    for (Index e = at.phyxels.offsets[k]; e < at.phyxels.offsets[k + 1]; ++e)
      sum += at.weights[e] * field[at.phyxels.indices[e]];
    return sum;
  }

  // Of the loads; of the springs, where these act. None if either is not known.
  void findExpectedErrors(MatchPotential &potential) {
    detail::LoadMatch::Variances ofSprings;
    if (!isExplained_ && !findVariances(potential, ofSprings)) return;
    if (hasLoads_ && variances_.posterior.empty()) return;
    const std::size_t n = u().size();
    variances_.posterior.resize(n, 0.0);
    variances_.prior.resize(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      double error = variances_.posterior[i], before = variances_.prior[i];
      if (!isExplained_) {
        error = std::max(error, ofSprings.posterior[i]);
        before = std::max(before, ofSprings.prior[i]);
      }
      const double expected = std::sqrt(error);
      out_.expectedErrors.push_back(expected);
      out_.isUnknown.push_back(expected > 2.0 * settings_.noise && expected > kUnknown * std::sqrt(before) ? 1 : 0);
    }
  }

  // Covariance τ H^-1 of the joint unknowns, and of the body alone without measurements.
  Result<void> findVariances(MatchPotential &potential, detail::LoadMatch::Variances &found) {
    const double temperature = stiffness_ * settings_.noise * settings_.noise;  // J
    Vector6 unused;
    Matrix6 hessian = Matrix6::Identity();
    if (!isMotionKnown())
      if (auto done = reducedHessian(potential, unused, hessian); !done) return done;
    const Eigen::LLT<Matrix6> motion(hessian);
    const MatchSprings none;
    const std::vector<Vec3> shape = u();
    const Interpolation at = sites();
    std::vector<Vec3> right(shape.size()), x(shape.size());
    const auto variance = [&](MatchPotential &of, detail::TangentSolver &solver) -> Result<std::vector<double>> {
      std::vector<double> out;
      for (std::size_t k = 0; k < at.count(); ++k) {
        double sum = 0.0;
        for (int c = 0; c < 3; ++c) {
          std::fill(right.begin(), right.end(), Vec3(Vec3::Zero()));
          for (Index e = at.phyxels.offsets[k]; e < at.phyxels.offsets[k + 1]; ++e)
            right[at.phyxels.indices[e]][c] += at.weights[e];
          auto done = solver.solve(of, right, x, kErrorTolerance, kMaxLinearIterations, Preconditioner::automatic,
                                   settings_.stop);
          if (!done) return tl::unexpected(done.error());
          sum += std::max(0.0, valueAt(at, k, x)[c]);
        }
        out.push_back(temperature * sum);
      }
      return out;
    };
    auto own = variance(potential, of_.tangent);
    if (!own) return tl::unexpected(own.error());
    if (!isMotionKnown())
      for (std::size_t k = 0; k < at.count(); ++k) {
        MatchSprings::Columns columns = terms_.motionColumns(at.positions[k] + valueAt(at, k, shape));
        for (std::size_t a = 0; a < 6; ++a) columns.col(static_cast<Eigen::Index>(a)) -= valueAt(at, k, responses_[a]);
        (*own)[k] += temperature * motion.matrixL().solve(columns.transpose()).squaredNorm();
      }
    MatchPotential alone(*of_.body, environment_, stage_, none, from_);
    (void)alone.setState(shape);
    detail::TangentSolver fresh;
    auto spread = variance(alone, fresh);
    if (!spread) return tl::unexpected(spread.error());
    interpolate(at, *own, *spread, found);
    return {};
  }

  // Between sites, by their distance (Shepard).
  void interpolate(const Interpolation &at, std::span<const double> own, std::span<const double> spread,
                   detail::LoadMatch::Variances &found) {
    const RestState &rest = of_.body->rest();
    for (const Vec3 &X : rest.positions) {
      double sum = 0.0, error = 0.0, before = 0.0;
      for (std::size_t k = 0; k < at.count(); ++k) {
        const double squared = (X - at.positions[k]).squaredNorm() + 1e-2 * rest.spacing * rest.spacing;
        const double w = 1.0 / (squared * squared);
        sum += w;
        error += w * own[k];
        before += w * spread[k];
      }
      found.posterior.push_back(error / sum);
      found.prior.push_back(before / sum);
    }
  }

  Impl &of_;
  const SurfaceMatchSettings &settings_;
  std::size_t points_, all_;
  Environment environment_;
  detail::ImplicitStage stage_;
  MatchTerms terms_;
  MatchSprings springs_;
  MatchMotion motion_;
  std::vector<Vec3> from_;                       // m, where the springs were made
  std::array<std::vector<Vec3>, 6> responses_;   // m per unit of the motion
  double unit_ = 0.0, stiffness_ = 0.0;          // N/m
  double lastDistance_ = 0.0;                    // m, of the iteration before
  int still_ = 0;                                // iterations in which it has hardly changed
  bool isStiff_ = false;                         // the stiffness has its last value
  bool hasLoads_ = false, isExplained_ = false;  // loads were found; and they explain the measurement within the noise
  detail::LoadMatch::Variances variances_;       // of the loads
  RobustLoss loss_ = RobustLoss::huber;
  SurfaceMatchResult out_;
};

}  // namespace

SurfaceMatch::SurfaceMatch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SurfaceMatch::~SurfaceMatch() = default;
SurfaceMatch::SurfaceMatch(SurfaceMatch &&) noexcept = default;
SurfaceMatch &SurfaceMatch::operator=(SurfaceMatch &&) noexcept = default;

Result<SurfaceMatch> SurfaceMatch::create(std::shared_ptr<const RestState> rest, const Constitution &constitution,
                                          const Foundation &foundation, const ParallelFor &parallelFor,
                                          const StopRequest *stop) {
  if (rest->skin.empty()) return tl::unexpected(std::string("the body has no skin that points could be compared with"));
  for (std::size_t l = 0; l < rest->conditions.loads.size(); ++l)
    if (rest->conditions.loads[l].pressure != 0.0 && rest->conditions.loads[l].follower)
      return tl::unexpected(
          "load " + std::to_string(l) +
          " is a pressure that follows the surface, which a match cannot keep; set follower to false");
  auto impl = std::make_unique<Impl>();
  impl->parallelFor = parallelFor;
  impl->skin = rest->surfels.expanded(rest->positions);
  impl->body = std::make_unique<Body>("match", std::move(rest), elasticOf(constitution), parallelFor);
  if (auto set = impl->body->setFoundation(foundation); !set) return tl::unexpected(set.error());
  if (!impl->body->held() && !foundation.holds())
    return tl::unexpected(
        std::string("nothing holds the body; a fix or a foundation with normal and tangential stiffness is required"));
  impl->patterns.emplace(impl->body->rest());
  impl->loads = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(impl->patterns->count()));
  try {
    if (auto done = impl->findEquilibrium(stop); !done) return tl::unexpected(done.error());
  } catch (const Stopped &) {
    return tl::unexpected(std::string("cancelled"));
  }
  return SurfaceMatch(std::move(impl));
}

Result<SurfaceMatchResult> SurfaceMatch::match(std::span<const MatchPoint> points,
                                               std::span<const MatchLandmark> landmarks,
                                               const SurfaceMatchSettings &settings) {
  if (std::string why = problemOf(points, landmarks, settings); !why.empty()) return tl::unexpected(std::move(why));
  const std::vector<Vec3> before = impl_->body->state().displacements;
  const Eigen::VectorXd loads = impl_->loads;
  const double stiffness = impl_->stiffness;
  std::string why;
  try {
    auto found = Iterations<Impl>(*impl_, points, landmarks, settings).run();
    if (found) return found;
    why = found.error();
  } catch (const Stopped &) {
    why = "cancelled";
  }
  impl_->stiffness = stiffness;
  impl_->setLoads(loads);
  impl_->body->state().displacements = before;
  impl_->newton.forget();
  impl_->tangent.forget();
  return tl::unexpected(std::move(why));
}

void SurfaceMatch::reset() {
  impl_->stiffness = 0.0;
  impl_->setLoads(Eigen::VectorXd::Zero(impl_->loads.size()));
  impl_->body->reset();
  impl_->newton.forget();
  impl_->tangent.forget();
  (void)impl_->findEquilibrium(nullptr);
}

}  // namespace pointbased
