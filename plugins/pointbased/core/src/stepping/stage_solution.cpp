// SPDX-License-Identifier: Apache-2.0
#include "stepping/stage_solution.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "pointbased/step_composition.h"

namespace pointbased::detail {
namespace {

constexpr int kContactRounds = 4;  // solutions of a stage until no point meets a surface that was not known
constexpr double kConfirmingOfDisplacements = 0.1;  // where nothing but displacements is asked of a step
constexpr double kLoosestOfDisplacements = 0.3;
constexpr double kLargestTolerance = 0.1;  // spacings: an impact takes ways of metres
constexpr double kRough = 100.0;           // tolerances within which a solution already tells what the contacts are
// change of the contact forces that is left to the next stage, of all that presses
constexpr double kSettled = 1e-2;

void addWork(const NewtonResult &solved, NewtonResult &sum) {
  const int iterations = sum.iterations, linear = sum.linearIterations, factorisations = sum.factorisations;
  sum = solved;
  sum.iterations += iterations;
  sum.linearIterations += linear;
  sum.factorisations += factorisations;
}

// Where a solution of the stage begins: of the free way and of what else is offered the state of lowest energy. A free
// way that goes deep into an obstacle is a bad beginning.
std::vector<Vec3> beginningOf(StageProblem &problem, const std::vector<std::vector<Vec3>> &offers) {
  std::size_t best = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < offers.size() && offers.size() > 1; ++k) {
    const double energy = problem.setState(offers[k]) ? problem.energy() : std::numeric_limits<double>::infinity();
    if (!(energy < lowest)) continue;
    lowest = energy;
    best = k;
  }
  return offers[best];
}

// Where a stage would end if nothing but inertia, gravity and damping were there: of a body that falls the solution.
void fallFreely(const Body &body, const Environment &env, const ImplicitStage &stage, std::span<Vec3> u) {
  const bool falls = !body.held() && pressingPoints(body.contact).empty();
  const Vec3 gained = falls ? Vec3(stage.h * stage.h * env.gravity) : Vec3(Vec3::Zero());
  const double slower = falls ? 1.0 / (1.0 + env.damping * stage.h) : 1.0;
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = stage.p[i] + slower * (stage.h * stage.q[i] + gained);
}

class StageSolution {
 public:
  StageSolution(Body &body, NewtonSolver &solver, const Environment &env, const ImplicitStage &stage,
                const StageRequest &request)
      : body_(body), solver_(solver), env_(env), stage_(stage), request_(request), problem_(body, env, stage),
        settings_(newtonSettings(body, env, stage.h <= 0.0)), start_(body.state().displacements), u_(start_) {
    if (stage.h > 0.0 && stage.tolerance > 0.0) {
      settings_.confirmingTolerance = kConfirmingOfDisplacements;
      settings_.firstTellsWay = env.contact();
      if (!env.contact()) settings_.loosestTolerance = kLoosestOfDisplacements;
      if (!(env.tolerance > 0.0)) settings_.toleranceOfWay = stage.tolerance;
      settings_.largestTolerance = kLargestTolerance * body.rest().spacing;
    }
    if (stage.h > 0.0) fallFreely(body, env, stage, u_);
    // Held phyxels and whatever they carry start where they have to be.
    body.placeHeld(stage.end, false);
    placed_ = body.state().displacements;
    hold(u_);
  }

  NewtonResult solve() {
    const bool touches = stagesOf(body_, env_).contact;
    bool complete = true;
    if (touches) {
      begin();
      complete = solveContacts();
    } else {
      (void)newton([&](const NewtonResult &) { return wanted(); });
    }
    // Of a stage that was given up, too: whoever solves it in another way may begin where this one has got to.
    (void)problem_.setState(u_);
    if (result_.good() && problem_.movesFreely()) {
      const Vec3 left = problem_.wayToMomentum();
      for (Vec3 &u : u_) u += left;
      (void)problem_.setState(u_);
    }
    memory().stageForces.begin(env_.obstacles.size());
    if (touches) sumContactForces(points(), problem_.penalty(), start_, u_, memory());
    if (touches && complete && result_.good()) finishContactStage(points(), problem_.penalty(), start_, u_, memory());
    return result_;
  }

 private:
  // What a round of contact has come to.
  enum class Round { again, restart, done, givenUp };

  [[nodiscard]] const ContactPoints &points() const { return body_.rest().contact; }
  [[nodiscard]] ContactState &memory() { return body_.contact; }
  [[nodiscard]] bool wanted() const { return !request_.shouldContinue || request_.shouldContinue(); }
  [[nodiscard]] bool goesOn() const { return !request_.goesOn || request_.goesOn(); }

  void hold(std::vector<Vec3> &at) const {
    for (std::size_t i = 0; i < at.size(); ++i)
      if (!body_.heldMask().empty() && body_.heldMask()[i]) at[i] = placed_[i];
  }

  void findContactsOfWay() {
    const ParallelFor &parallelFor = *env_.parallelFor;
    body_.state().displacements = start_;
    for (std::size_t i = 0; i < u_.size(); ++i)
      body_.state().velocities[i] =
          stage_.contactSpan > 0.0 ? Vec3((u_[i] - start_[i]) / stage_.contactSpan) : Vec3(Vec3::Zero());
    findContacts(env_.obstacles, env_.box, request_.from, stage_.contactSpan, kContactMargin * body_.rest().spacing,
                 body_.contactPositions(parallelFor), body_.contactVelocities(parallelFor), points().radii, memory(),
                 parallelFor);
  }

  [[nodiscard]] bool newton(const std::function<bool(const NewtonResult &)> &watch) {
    env_.clock->measure(kSolve, [&] { addWork(solver_.solve(problem_, u_, settings_, watch), result_); });
    settings_.toleranceDisplacement = std::max(settings_.toleranceDisplacement, result_.tolerance);
    settings_.toleranceOfWay = 0.0;
    return result_.good();
  }

  void updateFriction() { updateNormalForces(points(), problem_.penalty(), start_, u_, memory()); }
  void recordForces() { forces_.record(points(), problem_.penalty(), start_, u_, memory()); }
  [[nodiscard]] double changeOfForces() { return forces_.changeTo(points(), problem_.penalty(), start_, u_, memory()); }

  void begin() {
    freeMotion_ = u_;
    findContactsOfWay();
    if (!(stage_.h > 0.0) || memory().active.empty()) return;
    std::vector<std::vector<Vec3>> offers{u_, start_};
    if (!request_.offer.empty()) offers.emplace_back(request_.offer.begin(), request_.offer.end());
    for (std::vector<Vec3> &at : offers) hold(at);
    u_ = beginningOf(problem_, offers);
  }

  // @return false: given up, because it is not to go on
  bool solveContacts() {
    for (int round = 0; round < kContactRounds; ++round) {
      const Round outcome = solveRound(round);
      if (outcome == Round::done) return true;
      if (outcome == Round::givenUp) return false;
      if (outcome != Round::restart) continue;
      // Once more from the free motion, to the end.
      restarted_ = true;
      u_ = freeMotion_;
      round = -1;
    }
    return true;
  }

  Round solveRound(int round) {
    // Before the iterations have converged it is checked whether friction has changed with what presses now, or whether
    // the stage is to be given up: then the rest of them would be wasted.
    bool asked = restarted_ || round > 0, enough = false;
    const auto look = [&](const NewtonResult &r) {
      if (!wanted()) return false;
      if (asked || r.iterations == 0 || r.lastStep > kRough * settings_.toleranceDisplacement) return true;
      asked = true;
      kept_ = memory().active;
      recordForces();
      updateFriction();
      enough = !goesOn() || changeOfForces() > kSettled;
      if (!enough) memory().active.swap(kept_);
      return !enough;
    };
    const std::size_t before = memory().active.size();
    if (!newton(look) && !enough) return afterFailure();
    if (!enough) solution_ = u_;
    result_.outcome = NewtonOutcome::converged;
    // With the planes that the solution meets, and friction of its normal forces, the contact forces have to be those
    // it was found with; else it is solved again with what they are now.
    if (!enough) recordForces();
    updateFriction();
    findContactsOfWay();
    updateFriction();
    if (!goesOn()) return Round::givenUp;
    if (enough) return Round::again;
    const bool settled = changeOfForces() <= kSettled || (round > 0 && memory().active.size() == before);
    return settled ? Round::done : Round::again;
  }

  Round afterFailure() {
    if (result_.outcome == NewtonOutcome::cancelled || result_.outcome == NewtonOutcome::notFinite) return Round::done;
    if (!solution_.empty()) {
      // Friction stays that of the solution before.
      u_ = solution_;
      result_.outcome = NewtonOutcome::converged;
      return Round::done;
    }
    return restarted_ || stage_.h <= 0.0 ? Round::done : Round::restart;
  }

  Body &body_;
  NewtonSolver &solver_;
  const Environment &env_;
  const ImplicitStage &stage_;
  const StageRequest &request_;
  StageProblem problem_;
  NewtonSettings settings_;
  const std::vector<Vec3> start_;
  std::vector<Vec3> u_, placed_, freeMotion_;
  std::vector<Vec3> solution_;  // the last one
  std::vector<Contact> kept_;
  ContactForces forces_;
  NewtonResult result_;
  bool restarted_ = false;
};

}  // namespace

NewtonSettings newtonSettings(const Body &body, const Environment &env, bool isStatic) {
  NewtonSettings settings;
  settings.toleranceDisplacement = env.tolerance > 0.0 ? env.tolerance : (isStatic ? 1e-6 : 1e-5) * body.rest().spacing;
  settings.preconditioner = env.preconditioner;
  settings.stop = env.stop;
  settings.maxIterations = isStatic ? 60 : 30;
  // Under an obstacle inexact static steps stray: a cube under a plate took ten times as long with a tenth.
  settings.strongTolerance = isStatic && env.contact() ? 0.01 : 0.1;
  return settings;
}

std::string failureOf(const NewtonResult &result) {
  switch (result.outcome) {
    case NewtonOutcome::converged: return {};
    case NewtonOutcome::cancelled: return "cancelled";
    default: break;
  }
  const char *what = result.outcome == NewtonOutcome::iterationLimit ? "the equilibrium was not found in time"
                     : result.outcome == NewtonOutcome::notFinite    ? "a quantity is not finite"
                                                                     : "the energy could not be lowered further";
  return std::string(what) + " (residual " + number(result.residual, 4) + " N after " +
         std::to_string(result.iterations) + " iterations, last correction " + number(1000.0 * result.lastStep, 4) +
         " mm)";
}

std::vector<Index> pressingPoints(const ContactState &contact) {
  std::vector<Index> points;
  for (const Contact &c : contact.active)
    if (c.normalForce > 0.0 && (points.empty() || points.back() != c.point)) points.push_back(c.point);
  return points;
}

NewtonResult solveStage(Body &body, NewtonSolver &solver, const Environment &env, const ImplicitStage &stage,
                        const StageRequest &request) {
  return StageSolution(body, solver, env, stage, request).solve();
}

bool findContactsAlong(Body &body, const Environment &env, std::span<const Vec3> start, double time, double dt) {
  State &state = body.state();
  const std::vector<Vec3> u = state.displacements, v = state.velocities;
  for (std::size_t i = 0; i < u.size(); ++i) {
    state.velocities[i] = (u[i] - start[i]) / dt;
    state.displacements[i] = start[i];
  }
  const std::span<const Vec3> ways = body.contactVelocities(*env.parallelFor);
  findContacts(env.obstacles, env.box, time, dt, kContactMargin * body.rest().spacing,
               body.contactPositions(*env.parallelFor), ways, body.rest().contact.radii, body.contact,
               *env.parallelFor);
  state.displacements = u;
  state.velocities = v;
  return std::any_of(body.contact.active.begin(), body.contact.active.end(), [&](const Contact &c) {
    return c.gap + dt * (ways[c.point] - c.surfaceVelocity).dot(c.normal) < 0.0;
  });
}

}  // namespace pointbased::detail
