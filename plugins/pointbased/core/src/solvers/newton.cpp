// SPDX-License-Identifier: Apache-2.0
#include "pointbased/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/conjugate_gradients.h"
#include "solvers/preconditioner.h"

namespace pointbased {

using detail::addScaled;
using detail::dot;
using detail::LinearEnd;

namespace {

constexpr double kArmijo = 1e-4;        // part of the predicted decrease that a step must achieve
constexpr double kTightest = 1e-6;      // lower limit of the forcing terms
constexpr double kConfirming = 1e-3;    // linear tolerance of a step that ends the solve
constexpr double kResidualFall = 1e-6;  // of the first residual; see NewtonSettings::toleranceForce
constexpr double kRounding = 1e-10;     // relative change of the energy that may be round-off of a cancelled sum
constexpr double kOfReach = 2e-3;       // of a small increment, estimated from inertia alone: largest tolerance
constexpr double kSmall = 10.0;         // tolerances: size of such an increment
constexpr double kAsPromised = 0.75, kPoor = 0.25;  // parts of the predicted decrease
constexpr double kWiden = 2.0, kNarrow = 0.5;       // of the radius
// Times the estimate of the remaining error by the preconditioned gradient. With three, a spinning block had an error
// of 0.16 % instead of 0.05 %.
constexpr double kSafety = 12.0;
constexpr int kTrials = 48;
constexpr int kDoublings = 16;
constexpr int kPatience = 6;  // iterations without progress

}  // namespace

struct NewtonSolver::Impl {
  detail::PreconditionerOfParts keeper;
  detail::ConjugateGradients linear;
  std::vector<Vec3> start, gradient, right, direction, trial, trialGradient;
  const StopRequest *stop = nullptr;  // of the current solve
  double tolerance = 0.0;             // m, of the current solve
  double expected = 0.0;              // ratio of a solution to the preconditioned gradient; 0: unknown
  double radius = 0.0;                // trust-region radius, in the norm of the preconditioner
  NewtonResult result;

  NewtonResult solve(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings,
                     const std::function<bool(const NewtonResult &)> &shouldContinue);

 private:
  struct Direction {
    bool newton = false;       // solved to `tolerance`, without negative curvature
    bool negative = false;     // truncated by negative curvature
    bool confirms = false;     // accurate enough to end the solve
    bool bounded = false;      // truncated by the radius
    bool isConverged = false;  // the estimated remaining error is within the tolerance
    bool hasPath = false;      // it is the end of the path of the linear solve
    double tolerance = 1.0;
    double length = 0.0;  // in the norm of the preconditioner
    double gain = 0.0;    // J, predicted by the quadratic model
  };
  struct Evaluation {
    double energy = 0.0;
    double norm = 0.0;  // of the gradient
    detail::Largest residual;
  };

  bool gradientHere(IncrementalPotential &problem, std::vector<Vec3> &out, Evaluation &at);
  bool applyLastCorrection(IncrementalPotential &problem, std::span<Vec3> u);
  bool tryAt(IncrementalPotential &problem, std::span<const Vec3> u, double scale, double &energy);
  Direction findDirection(IncrementalPotential &problem, const NewtonSettings &settings, double forcing,
                          double strongForcing);
  double search(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings, Evaluation &at,
                bool grow, double pathLength);
};

NewtonSolver::NewtonSolver() : impl_(std::make_unique<Impl>()) {}
NewtonSolver::~NewtonSolver() = default;
NewtonSolver::NewtonSolver(NewtonSolver &&) noexcept = default;
NewtonSolver &NewtonSolver::operator=(NewtonSolver &&) noexcept = default;
void NewtonSolver::forget() { impl_->keeper.forget(); }
const NewtonResult &NewtonSolver::progress() const { return impl_->result; }

NewtonResult NewtonSolver::solve(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings,
                                 const std::function<bool(const NewtonResult &)> &shouldContinue) {
  try {
    return impl_->solve(problem, u, settings, shouldContinue);
  } catch (const Stopped &) {
    forget();  // a factorisation may be incomplete
    throw;
  }
}

namespace {

// Change of the energy that may be round-off only.
double noise(const IncrementalPotential &problem, double a, double b) {
  return kRounding * (std::abs(a) + std::abs(b)) + problem.roundOff();
}

void clearPrescribed(std::span<const std::uint8_t> prescribed, std::span<Vec3> v) {
  for (std::size_t i = 0; i < prescribed.size(); ++i)
    if (prescribed[i] != 0) v[i].setZero();
}

double longestWay(std::span<const Vec3> from, std::span<const Vec3> to) {
  double squared = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) squared = std::max(squared, (to[i] - from[i]).squaredNorm());
  return std::sqrt(squared);
}

}  // namespace

// Gradient of free phyxels at the current state of the problem.
bool NewtonSolver::Impl::gradientHere(IncrementalPotential &problem, std::vector<Vec3> &out, Evaluation &at) {
  problem.gradient(out);
  clearPrescribed(problem.prescribed(), out);
  at.residual = detail::largest(out);
  at.norm = std::sqrt(dot(out, out));
  return std::isfinite(at.residual.value);
}

// Moves to u + scale direction.
bool NewtonSolver::Impl::tryAt(IncrementalPotential &problem, std::span<const Vec3> u, double scale, double &energy) {
  throwIfStopRequested(stop);
  trial.assign(u.begin(), u.end());
  addScaled(scale, direction, trial);
  if (!problem.setState(trial)) return false;
  energy = problem.energy();
  return std::isfinite(energy);
}

NewtonSolver::Impl::Direction NewtonSolver::Impl::findDirection(IncrementalPotential &problem,
                                                                const NewtonSettings &settings, double forcing,
                                                                double strongForcing) {
  const std::size_t n = gradient.size();
  const int solvedBefore = result.linearIterations;
  const std::span<const std::uint8_t> prescribed = problem.prescribed();
  const detail::Apply product = [&](std::span<const Vec3> in, std::span<Vec3> out) {
    throwIfStopRequested(settings.stop);
    result.linearIterations = solvedBefore + linear.iterations();
    problem.product(in, out);
    clearPrescribed(prescribed, out);
  };
  const detail::Apply precondition = [&](std::span<const Vec3> in, std::span<Vec3> out) { keeper.apply(in, out); };

  keeper.prepare(problem, settings.preconditioner, settings.stop);
  right.resize(n);
  for (std::size_t i = 0; i < n; ++i) right[i] = -gradient[i];
  linear.begin(right, precondition);
  if (expected > 0.0 && keeper.isStrong() && expected * detail::largest(linear.preconditioned()).value <= tolerance) {
    Direction none;
    none.isConverged = true;
    direction.assign(linear.preconditioned().begin(), linear.preconditioned().end());
    return none;
  }

  Direction out;
  out.tolerance = keeper.isStrong() ? strongForcing : forcing;
  const double confirming =
      keeper.isStrong() ? settings.confirmingTolerance : std::min(settings.confirmingTolerance, kConfirming);
  int before = 0;  // iterations with discarded preconditioners
  LinearEnd end;
  for (;;) {
    const int most = settings.maxLinearIterations - linear.iterations();
    const int spent = linear.iterations() - before;
    const int iterationBudget = keeper.iterationBudget(out.tolerance, settings.maxLinearIterations) - spent;
    end = linear.run(product, precondition, out.tolerance, std::max(0, std::min(most, iterationBudget)), radius);
    // the current preconditioner performs poorly: a new one is cheaper
    if (end == LinearEnd::iterations && iterationBudget < most) {
      keeper.book(linear.iterations() - before, out.tolerance, false);
      keeper.renew(problem, settings.stop);
      before = linear.iterations();
      linear.restart(product, precondition);
      continue;
    }
    // A step so small that it would end the solve has to be accurate.
    if (end == LinearEnd::tolerance && out.tolerance > confirming && detail::largest(linear.x()).value <= tolerance) {
      out.tolerance = confirming;
      continue;
    }
    break;
  }
  keeper.book(linear.iterations() - before, out.tolerance, end == LinearEnd::tolerance);
  out.bounded = end == LinearEnd::radius;
  out.hasPath = linear.iterations() > 0;
  out.length = linear.length();
  out.gain = linear.gain();
  result.linearIterations = solvedBefore + linear.iterations();

  out.newton = end == LinearEnd::tolerance;
  out.confirms = out.tolerance <= confirming;
  out.negative = end == LinearEnd::negativeCurvature;
  const std::span<const Vec3> found = linear.iterations() > 0 ? linear.x() : linear.preconditioned();
  direction.assign(found.begin(), found.end());
  // Not a descent direction (round-off, or an operator that is not symmetric): the preconditioned gradient, at worst
  // the plain gradient.
  const auto downhill = [this] {
    return dot(gradient, direction) < 0.0 && std::isfinite(detail::largest(direction).value);
  };
  if (!downhill()) {
    out.newton = out.hasPath = false;
    direction.assign(linear.preconditioned().begin(), linear.preconditioned().end());
    if (!downhill()) direction = right;
  }
  return out;
}

// Line search: moves u along the direction, and leaves the problem, the gradient and `at` at the new state. Returns the
// scale, or 0 if no decrease was found and nothing has changed.
// @param grow  the direction has no natural length: longer steps are tried
// @param pathLength  length of the path of the linear solve, along which a failed step is shortened, and which then
//                    sets the radius; 0: straight
double NewtonSolver::Impl::search(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &settings,
                                  Evaluation &at, bool grow, double pathLength) {
  double slope = dot(gradient, direction);
  const double length = detail::largest(direction).value;
  const double limit = std::min(1.0, problem.largestStep(direction));
  if (!(limit > 0.0) || !(slope < 0.0)) return 0.0;
  // Shorter steps are irrelevant, or change no digit of u.
  const double smallest = std::max(1e-3 * settings.toleranceDisplacement, 1e-17 * detail::largest(u).value);

  Evaluation next;
  double scale = limit, along = limit;  // of the direction; of the current direction, a point of the path
  bool found = false;
  for (int k = 0; k < kTrials && !found; ++k) {
    if (k > 0 && scale * length < smallest) break;
    if (k > 0 && pathLength > 0.0) {
      linear.pointOnPath(scale * pathLength, direction);
      slope = dot(gradient, direction);
      along = std::min(1.0, problem.largestStep(direction));
      if (!(along > 0.0) || !(slope < 0.0)) {
        scale *= 0.5;
        continue;
      }
    } else {
      along = scale;
    }
    if (!tryAt(problem, u, along, next.energy)) {
      scale *= 0.5;
      continue;
    }
    const double change = next.energy - at.energy;
    if (change <= kArmijo * along * slope) {
      found = gradientHere(problem, trialGradient, next);
      if (!found) scale *= 0.5;
      continue;
    }
    // If the change of the energy is below round-off, the gradients decide. The slope along the step must indicate a
    // decrease, and the gradient must decrease as well, except when leaving a saddle point.
    found = std::abs(change) <= noise(problem, at.energy, next.energy) && gradientHere(problem, trialGradient, next) &&
            (grow || next.norm < at.norm) && dot(trialGradient, direction) <= (2.0 * kArmijo - 1.0) * slope;
    if (found) continue;
    // Minimum of the parabola through the known values.
    const double lowest = -0.5 * slope * along * scale / (change - slope * along);
    scale = std::isfinite(lowest) ? std::clamp(lowest, 0.1 * scale, 0.5 * scale) : 0.5 * scale;
  }
  if (!found) {
    (void)problem.setState(u);
    return 0.0;
  }
  if (scale < limit && pathLength > 0.0) radius = scale * pathLength;

  if (grow && scale == 1.0) {
    Evaluation longer;
    for (int k = 0; k < kDoublings; ++k) {
      for (Vec3 &d : direction) d *= 2.0;
      bool lower = problem.largestStep(direction) >= 1.0 && tryAt(problem, u, 1.0, longer.energy);
      if (lower && std::abs(longer.energy - next.energy) <= noise(problem, longer.energy, next.energy)) {
        lower = gradientHere(problem, trialGradient, longer) && dot(trialGradient, direction) < 0.0;
      } else {
        lower = lower && longer.energy < next.energy;
      }
      if (!lower) {
        for (Vec3 &d : direction) d *= 0.5;
        break;
      }
      next.energy = longer.energy;
    }
    if (!tryAt(problem, u, 1.0, next.energy) || !gradientHere(problem, trialGradient, next)) {
      (void)problem.setState(u);
      return 0.0;
    }
  }

  std::copy(trial.begin(), trial.end(), u.begin());
  gradient.swap(trialGradient);
  at = next;
  return scale;
}

bool NewtonSolver::Impl::applyLastCorrection(IncrementalPotential &problem, std::span<Vec3> u) {
  if (problem.largestStep(direction) < 1.0) return false;
  trial.assign(u.begin(), u.end());
  addScaled(1.0, direction, trial);
  if (!problem.setState(trial)) {
    (void)problem.setState(u);
    return false;
  }
  std::copy(trial.begin(), trial.end(), u.begin());
  result.lastStep = detail::largest(direction).value;
  return true;
}

NewtonResult NewtonSolver::Impl::solve(IncrementalPotential &problem, std::span<Vec3> u, const NewtonSettings &asked,
                                       const std::function<bool(const NewtonResult &)> &shouldContinue) {
  NewtonSettings settings = asked;
  result = NewtonResult();
  stop = settings.stop;
  tolerance = settings.toleranceDisplacement;
  const std::size_t n = problem.phyxels();
  const int factorisationsBefore = keeper.factorisations();
  gradient.resize(n);
  trialGradient.resize(n);

  Evaluation at;
  bool isWithinAsked = false;  // the initial error is below the requested tolerance: round-off may end the solve
  const auto end = [&](NewtonOutcome outcome) {
    const bool isGivenUp = outcome == NewtonOutcome::noDescent || outcome == NewtonOutcome::iterationLimit;
    result.outcome = isWithinAsked && isGivenUp ? NewtonOutcome::converged : outcome;
    return result;
  };
  const auto report = [&] {
    result.residual = at.residual.value;
    result.worst = at.residual.at;
    result.tolerance = tolerance;
    result.factorisations = keeper.factorisations() - factorisationsBefore;
  };
  if (n == 0) return end(NewtonOutcome::converged);
  const bool evaluated = u.size() == n && problem.setState(u) && std::isfinite(at.energy = problem.energy());
  if (!evaluated) {
    const detail::Largest where = detail::largest(u);
    result.residual = std::numeric_limits<double>::quiet_NaN();
    result.worst = std::isfinite(where.value) ? 0 : where.at;
    return end(NewtonOutcome::notFinite);
  }
  const bool finite = gradientHere(problem, gradient, at);
  report();
  if (!finite) return end(NewtonOutcome::notFinite);

  const double reach = problem.reach(gradient);
  if (reach <= 0.0) return end(NewtonOutcome::converged);
  // An increment below the tolerance matters: over many steps it adds up to the whole motion.
  const bool isSmall = reach <= kSmall * asked.toleranceDisplacement;
  isWithinAsked = reach <= asked.toleranceDisplacement;
  if (isSmall) {
    const double roundOff = 8.0 * std::numeric_limits<double>::epsilon() * detail::largest(u).value;
    settings.toleranceDisplacement = std::min(asked.toleranceDisplacement, std::max(roundOff, kOfReach * reach));
  }
  tolerance = settings.toleranceDisplacement;

  start.assign(u.begin(), u.end());
  const double first = at.residual.value;
  const auto fallen = [&] { return at.residual.value <= kResidualFall * first; };
  radius = std::numeric_limits<double>::infinity();
  expected = 0.0;
  double forcing = settings.linearTolerance, strongForcing = settings.strongTolerance;
  double bestResidual = first;
  int idle = 0, small = 0;
  for (;;) {
    if (at.residual.value <= std::max(0.0, settings.toleranceForce)) return end(NewtonOutcome::converged);
    if (result.iterations >= settings.maxIterations) return end(NewtonOutcome::iterationLimit);
    if (shouldContinue && !shouldContinue(result)) return end(NewtonOutcome::cancelled);
    ++result.iterations;

    const Evaluation before = at;
    const Direction found = findDirection(problem, settings, forcing, strongForcing);
    if (found.isConverged && applyLastCorrection(problem, u)) return end(NewtonOutcome::converged);
    bool newton = found.newton;
    double length = detail::largest(direction).value;
    double scale =
        search(problem, u, settings, at, found.negative, settings.trustRegion && found.hasPath ? found.length : 0.0);
    if (scale == 0.0) {
      // At the resolution of the digits of u no further improvement is possible.
      if (newton && length <= std::max(settings.toleranceDisplacement,
                                       8.0 * std::numeric_limits<double>::epsilon() * detail::largest(u).value)) {
        result.lastStep = length;
        report();
        return end(NewtonOutcome::converged);
      }
      newton = false;
      direction.assign(linear.preconditioned().begin(), linear.preconditioned().end());
      length = detail::largest(direction).value;
      scale = search(problem, u, settings, at, false, 0.0);
      if (scale == 0.0) {
        report();
        return end(fallen() ? NewtonOutcome::converged : NewtonOutcome::noDescent);
      }
    } else {
      length = detail::largest(direction).value;  // it may have grown
      const double gain = before.energy - at.energy;
      if (found.bounded && scale == 1.0 && !(gain > kPoor * found.gain))
        radius = kNarrow * found.length;
      else if (found.bounded && scale == 1.0 && gain > kAsPromised * found.gain)
        radius = kWiden * found.length;
    }
    result.lastStep = scale * length;
    isWithinAsked = isWithinAsked || (isSmall && newton && scale == 1.0 && length <= asked.toleranceDisplacement);
    expected = settings.relativeStepTolerance > 0.0 && !settings.calibrateFromFirstStep && newton && scale == 1.0
                   ? kSafety * std::max(1.0, length / detail::largest(linear.preconditioned()).value)
                   : 0.0;
    const bool isCalibrated = !settings.calibrateFromFirstStep || (result.iterations == 1 && newton && scale == 1.0);
    if (settings.relativeStepTolerance > 0.0 && isCalibrated)
      tolerance = std::max(settings.toleranceDisplacement,
                           std::min(settings.largestTolerance, settings.relativeStepTolerance * longestWay(start, u)));
    report();

    // Converged: a full, accurate Newton step that moved nothing by more than the tolerance, after which the residual
    // is smaller; or two such steps in a row if it cannot decrease.
    if (newton && scale == 1.0 && result.lastStep <= tolerance && (found.confirms || fallen())) {
      if (at.residual.value <= before.residual.value || ++small >= 2) return end(NewtonOutcome::converged);
    } else {
      small = 0;
    }

    // No gain in energy or residual for several iterations: give up.
    const bool lower = before.energy - at.energy > noise(problem, before.energy, at.energy);
    idle = lower || at.residual.value < 0.9 * bestResidual ? 0 : idle + 1;
    bestResidual = std::min(bestResidual, at.residual.value);
    if (idle >= kPatience) return end(fallen() ? NewtonOutcome::converged : NewtonOutcome::noDescent);

    // Second choice of Eisenstat and Walker, with their safeguard against premature tightening.
    const double ratio = at.norm / before.norm;
    double wanted = 0.9 * ratio * ratio;
    strongForcing = std::max(settings.strongTolerance, std::min(wanted, settings.loosestTolerance));
    if (0.9 * forcing * forcing > 0.1) wanted = std::max(wanted, 0.9 * forcing * forcing);
    forcing = std::clamp(wanted, std::min(kTightest, settings.linearTolerance), settings.linearTolerance);
  }
}

}  // namespace pointbased
