// SPDX-License-Identifier: Apache-2.0
#include "pointbased/surface_match.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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
constexpr int kRigidIterations = 60, kFurtherRigidIterations = 5;  // of a first and of a further match
constexpr double kSmallChange = 0.1;     // of the noise: change of the distances that ends the match
constexpr double kSettled = 0.01;        // relative change of the distance that ends it as well, twice in a row
constexpr double kAsNoise = 1.1;         // of the noise: distances that are explained
constexpr double kFirstStiffness = 0.1;  // of all springs together, over E times the size of the body
constexpr double kLastStiffness = 200.0, kStiffer = 3.0;
constexpr double kNear = 2.0, kALittleStiffer = 1.6;     // of the noise: distances from which on it increases slowly
constexpr double kTurnSpread = 0.5, kShiftSpread = 0.2;  // rad, m: motions that are expected of a body at the start
constexpr double kLongWave = 0.5;                        // of the size: deformations that the first forces found hold
constexpr double kSettledShift = 0.05;  // of the noise, root mean square: shape in equilibrium from the shape matched
constexpr double kStifferHold = 6.0;    // per try
constexpr int kHoldTries = 12;
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
  double stiffness = 0.0;  // N/m, of the springs of the last match; 0: none
  std::unique_ptr<detail::LoadResponse> response;
  Eigen::VectorXd loads;  // Pa, amplitudes of the patterns

  [[nodiscard]] Environment environment(const StopRequest *stop) {
    Environment out;
    out.parallelFor = &parallelFor;
    out.clock = &clock;
    out.stop = stop;
    return out;
  }
  // Before the first match, with the body in equilibrium without further forces.
  [[nodiscard]] Result<void> findResponse(const StopRequest *stop) {
    if (response) return {};
    auto found = detail::LoadResponse::create(*body, detail::LoadPatterns(body->rest()), environment(stop));
    if (!found) return tl::unexpected("body '" + body->name() + "': " + found.error());
    response = std::move(*found);
    loads = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(response->count()));
    return {};
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
    double mass = 0.0;
    for (const double m : of.body->masses()) mass += m;
    const double waveNumber = 2.0 * std::numbers::pi / (kLongWave * std::cbrt(volume));
    firstHold_ = modulus * volume / mass * waveNumber * waveNumber;
  }

  Result<SurfaceMatchResult> run() {
    terms_.evaluate(u(), motion_);
    if (!terms_.sees())
      return tl::unexpected(
          std::string("no part of the skin faces any of the points; their normals may point inwards"));
    weigh();
    out_.distanceAtStart = terms_.distance();
    const bool isFirst = of_.stiffness == 0.0;
    if (!settings_.isMotionKnown && isFirst)
      alignRigidly(of_.loads.isZero(0.0) ? kRigidIterations : kFurtherRigidIterations);
    out_.distanceRigid = terms_.distance();
    out_.rigid = motion_;
    if (auto done = fitLoads(); !done) return tl::unexpected(done.error());
    if (terms_.misfit() <= kAsNoise) return finish();
    stiffness_ = isFirst ? kFirstStiffness * unit_ : of_.stiffness;
    isStiff_ = !isFirst;
    bool hasConverged = false;
    for (int k = 1; k <= settings_.maxIterations && !hasConverged; ++k) {
      ++out_.iterations;
      if (settings_.progress && !settings_.progress({k, settings_.maxIterations, terms_.distance(), u(), motion_}))
        return tl::unexpected(std::string("cancelled"));
      auto done = iterate();
      if (!done) {
        u() = byLoads_;
        stiffness_ = 0.0;
        break;
      }
      hasConverged = *done;
    }
    out_.hasConverged = hasConverged;
    of_.stiffness = stiffness_;
    return finish();
  }

 private:
  [[nodiscard]] std::vector<Vec3> &u() { return of_.body->state().displacements; }
  void weigh() { terms_.weigh(loss_, terms_.spread()); }

  // Smooth loads and the motion. Springs follow only where these do not explain the measurement.
  Result<void> fitLoads() {
    detail::LoadMatch loads(u(), of_.body->rest(), *of_.response, terms_, settings_, of_.parallelFor);
    if (auto done = loads.run(of_.loads, motion_); !done) return done;
    out_.iterations = loads.iterations();
    out_.hasConverged = loads.hasConverged();
    loss_ = RobustLoss::tukey;
    if (settings_.findsExpectedErrors) variances_ = loads.variances(of_.loads);
    hold();
    byLoads_ = u();
    terms_.evaluate(u(), motion_);
    weigh();
    return {};
  }

  // Finds forces that hold the shape in equilibrium: those of soft springs between each phyxel and its position in it.
  // Deformations of short wavelength relax. The forces become the external forces of the body.
  void hold() {
    const std::vector<Vec3> shape = u();
    std::vector<Vec3> forces(shape.size(), Vec3::Zero()), at;
    of_.body->swapExternalForces(forces);
    forces.assign(shape.size(), Vec3::Zero());
    double stiffness = firstHold_;  // 1/s²
    for (int k = 0; k < kHoldTries; ++k, stiffness *= kStifferHold) {
      u() = at = shape;
      detail::ImplicitStage stage = stage_;
      stage.holding = stiffness;
      detail::StageProblem problem(*of_.body, environment_, stage);
      const NewtonResult solved = of_.newton.solve(problem, at, newtonSettings(0.0));
      double squared = 0.0;
      for (std::size_t i = 0; i < at.size(); ++i) squared += (at[i] - shape[i]).squaredNorm();
      const double shift = std::sqrt(squared / static_cast<double>(at.size()));
      if (!detail::failureOf(solved).empty() || !(shift < kSettledShift * settings_.noise)) continue;
      for (std::size_t i = 0; i < at.size(); ++i) forces[i] = stiffness * of_.body->masses()[i] * (shape[i] - at[i]);
      (void)problem.setState(at);
      of_.body->swapExternalForces(forces);
      return;
    }
    u() = shape;
    detail::StageProblem problem(*of_.body, environment_, stage_);
    (void)problem.setState(shape);
    problem.gradient(forces);
    detail::clearPrescribed(problem, forces);
    of_.body->swapExternalForces(forces);
  }

  // Iterative closest points of the body as it is.
  void alignRigidly(int iterations) {
    const double variance = settings_.noise * settings_.noise;
    for (int k = 0; k < iterations; ++k) {
      terms_.springs(1.0, springs_);
      Vector6 gradient;
      Matrix6 hessian;
      springs_.ofMotion(gradient, hessian);
      hessian.diagonal().head<3>().array() += variance / (kTurnSpread * kTurnSpread);
      hessian.diagonal().tail<3>().array() += variance / (kShiftSpread * kShiftSpread);
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

  // Equilibrium with the springs. Errors: there is none.
  [[nodiscard]] Result<void> solve(MatchPotential &potential, double tolerance) {
    std::vector<Vec3> at = u();
    const NewtonResult solved = of_.newton.solve(potential, at, newtonSettings(tolerance));
    if (std::string why = detail::failureOf(solved); !why.empty())
      return tl::unexpected("the equilibrium of the match was not found: " + why);
    (void)potential.setState(at);
    return {};
  }

  // One round of closest points, at constant motion. Whether the result has converged.
  Result<bool> iterate() {
    terms_.springs(stiffness_, springs_);
    const std::vector<Vec3> before = from_ = u();
    {
      MatchPotential potential(*of_.body, environment_, stage_, springs_, from_);
      if (auto done = solve(potential, kLooseTolerance * of_.body->rest().spacing); !done)
        return tl::unexpected(done.error());
    }
    terms_.evaluate(u(), motion_);
    weigh();
    const double distance = terms_.distance();
    if (!isStiff_) {
      const double misfit = terms_.misfit();
      if (misfit <= kAsNoise || stiffness_ >= kLastStiffness * unit_)
        isStiff_ = true;
      else
        stiffness_ *= misfit > kNear ? kStiffer : kALittleStiffer;
      return false;
    }
    if (loss_ == RobustLoss::huber) {
      loss_ = RobustLoss::tukey;
      weigh();
      return false;
    }
    double change = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) change += (u()[i] - before[i]).squaredNorm();
    // Closest points jump between triangles, so that single positions keep changing a little.
    still_ = std::abs(distance - lastDistance_) < kSettled * lastDistance_ ? still_ + 1 : 0;
    lastDistance_ = distance;
    return std::sqrt(change / static_cast<double>(before.size())) < kSmallChange * settings_.noise || still_ >= 2;
  }

  Result<SurfaceMatchResult> finish() {
    const std::span<const Vec3> loads = of_.body->externalForces();
    out_.forces.assign(loads.begin(), loads.end());
    if (stiffness_ > 0.0) {
      terms_.springs(stiffness_, springs_);
      from_ = u();
      MatchPotential potential(*of_.body, environment_, stage_, springs_, from_);
      if (auto done = solve(potential, 0.0); !done) return tl::unexpected(done.error());
      springs_.addForces(potential.since(), out_.forces);
    }
    out_.displacements = u();
    terms_.evaluate(u(), motion_);
    weigh();
    out_.distance = terms_.distance();
    if (settings_.findsExpectedErrors) findExpectedErrors();
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

  // What springs have changed is an error of the loads, from which the unseen part is known. So is what remains.
  void findExpectedErrors() {
    const double explained = kAsNoise * settings_.noise;
    const double unexplained = std::max(0.0, out_.distance * out_.distance - explained * explained);
    for (std::size_t i = 0; i < variances_.posterior.size(); ++i) {
      const double expected = std::sqrt(variances_.posterior[i] + unexplained + (u()[i] - byLoads_[i]).squaredNorm());
      out_.expectedErrors.push_back(expected);
      out_.isUnknown.push_back(
          expected > 2.0 * settings_.noise && expected > kUnknown * std::sqrt(variances_.prior[i]) ? 1 : 0);
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
  std::vector<Vec3> from_, byLoads_;        // m, where the springs were made; and without these
  double unit_ = 0.0, stiffness_ = 0.0;     // N/m
  double firstHold_ = 0.0;                  // 1/s², stiffness over mass
  double lastDistance_ = 0.0;               // m, of the iteration before
  int still_ = 0;                           // iterations in which it has hardly changed
  bool isStiff_ = false;                    // the stiffness has its last value
  detail::LoadMatch::Variances variances_;  // of the loads
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
  const std::span<const Vec3> external = impl_->body->externalForces();
  std::vector<Vec3> forces(external.begin(), external.end());
  const Eigen::VectorXd loads = impl_->loads;
  const double stiffness = impl_->stiffness;
  std::string why;
  try {
    if (auto done = impl_->findResponse(settings.stop); !done) return tl::unexpected(done.error());
    auto found = Iterations<Impl>(*impl_, points, landmarks, settings).run();
    if (found) return found;
    why = found.error();
  } catch (const Stopped &) {
    why = "cancelled";
  }
  impl_->stiffness = stiffness;
  if (impl_->response) impl_->loads = loads.size() > 0 ? loads : Eigen::VectorXd::Zero(impl_->loads.size());
  impl_->body->swapExternalForces(forces);
  impl_->body->state().displacements = before;
  impl_->newton.forget();
  return tl::unexpected(std::move(why));
}

void SurfaceMatch::reset() {
  impl_->stiffness = 0.0;
  impl_->loads.setZero();
  std::vector<Vec3> none;
  impl_->body->swapExternalForces(none);
  impl_->body->reset();
  impl_->newton.forget();
  (void)impl_->findEquilibrium(nullptr);
}

}  // namespace pointbased
