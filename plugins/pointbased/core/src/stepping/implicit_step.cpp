// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/stage_solution.h"

namespace pointbased {

using namespace detail;

namespace {

// Of the accelerations: a beam of 1 MPa in steps of 1/60 s came to 1e-3 of the way at its tip (and to 2e-5) of where
// solutions to 1e-5 of the spacing brought it, at half and two thirds of the cost.
constexpr double kErrorOfEuler = 0.05, kErrorOfSdirk = 2e-3;

// One step by one of the schemes, without what the state at its end needs.
class ImplicitStep {
 public:
  ImplicitStep(Body &body, NewtonSolver &solver, const Environment &env, double time, double dt)
      : body_(body), solver_(solver), env_(env), time_(time), dt_(dt), u0_(body.state().displacements),
        v0_(body.state().velocities), contactsBefore_(body.contact.active),
        pressedBefore_(pressingPoints(body.contact)), sums_(body.contact.sums) {}

  NewtonResult solve(Integrator scheme) {
    switch (scheme) {
      case Integrator::implicitMidpoint: midpoint(); break;
      case Integrator::implicitSdirk: sdirk(); break;
      default:
        stage_ = {dt_, time_ + dt_, dt_, u0_, v0_, 0.0, dt_, kErrorOfEuler};
        solveStage(time_);
        addStageForces(dt_, body_.contact);
        break;
    }
    return result_;
  }

 private:
  void solveStage(double from, const std::function<bool()> &goesOn = {}, std::span<const Vec3> offer = {}) {
    const int iterations = result_.iterations, linearIterations = result_.linearIterations;
    result_ = detail::solveStage(body_, solver_, env_, stage_, {from, offer, {}, goesOn});
    result_.iterations += iterations;
    result_.linearIterations += linearIterations;
  }

  // Both second-order schemes continue the forces of a first stage beyond it. Those of an impact do not go on, and
  // would throw the body back with more than its energy: such steps are backward Euler, an inelastic impact.
  void backwardEulerInstead() {
    State &state = body_.state();
    const std::vector<Vec3> reached = state.displacements;
    state.displacements = u0_;
    state.velocities = v0_;
    body_.contact.active = contactsBefore_;
    stage_ = {dt_, time_ + dt_, dt_, u0_, v0_, 0.0, dt_, kErrorOfEuler};
    solveStage(time_, {}, reached);
    body_.contact.sums = sums_;
    addStageForces(dt_, body_.contact);
  }

  void midpoint() {
    State &state = body_.state();
    bool impact = false;
    stage_ = {0.5 * dt_, time_ + 0.5 * dt_, 0.5 * dt_, u0_, v0_, 0.0, 0.5 * dt_};
    solveStage(time_, [&] { return !(impact = !pressingPoints(body_.contact).empty()); });
    if (result_.good() && impact) return backwardEulerInstead();
    addStageForces(dt_, body_.contact);
    for (std::size_t i = 0; i < u0_.size(); ++i) {
      const Vec3 middle = state.displacements[i];
      state.displacements[i] = 2.0 * middle - u0_[i];
      state.velocities[i] = 2.0 * (state.displacements[i] - u0_[i]) / dt_ - v0_[i];
    }
    // What the second half meets, the middle has not seen.
    if (result_.good() && stagesOf(body_, env_).contact && findContactsAlong(body_, env_, u0_, time_, dt_))
      backwardEulerInstead();
  }

  void sdirk() {
    const State &state = body_.state();
    const double gamma = 1.0 - std::sqrt(0.5);
    bool impact = false;
    stage_ = {gamma * dt_, time_ + gamma * dt_, gamma * dt_, u0_, v0_, 0.0, gamma * dt_, kErrorOfSdirk};
    solveStage(time_, [&] { return !(impact = meetsAnew()); });
    if (!result_.good()) return;
    if (impact) return backwardEulerInstead();
    addStageForces((1.0 - gamma) * dt_, body_.contact);
    for (std::size_t i = 0; i < u0_.size(); ++i) {
      const Vec3 k = state.velocities[i], l = (state.velocities[i] - v0_[i]) / (gamma * dt_);
      stage_.p[i] = u0_[i] + (1.0 - gamma) * dt_ * k;
      stage_.q[i] = v0_[i] + (1.0 - gamma) * dt_ * l;
    }
    stage_.end = time_ + dt_;
    stage_.elapsed = dt_;
    stage_.contactSpan = (1.0 - gamma) * dt_;
    solveStage(time_ + gamma * dt_);
    addStageForces(gamma * dt_, body_.contact);
  }

  // A point presses that did not before, or one is led out of an obstacle.
  [[nodiscard]] bool meetsAnew() const {
    const std::vector<Index> pressed = pressingPoints(body_.contact);
    const bool leadsOut = std::any_of(body_.contact.active.begin(), body_.contact.active.end(),
                                      [](const Contact &c) { return c.initialPenetration > 0.0; });
    return leadsOut || !std::includes(pressedBefore_.begin(), pressedBefore_.end(), pressed.begin(), pressed.end());
  }

  Body &body_;
  NewtonSolver &solver_;
  const Environment &env_;
  double time_, dt_;
  const std::vector<Vec3> u0_, v0_;
  const std::vector<Contact> contactsBefore_;
  const std::vector<Index> pressedBefore_;
  const ContactSums sums_;  // of the pieces of the step before this one
  ImplicitStage stage_;
  NewtonResult result_;
};

}  // namespace

ImplicitResult implicitStep(Body &body, NewtonSolver &solver, const Environment &env, double time, double dt,
                            Integrator scheme) {
  const ParallelFor &parallelFor = *env.parallelFor;
  ImplicitResult out;
  out.newton = ImplicitStep(body, solver, env, time, dt).solve(scheme);
  if (out.failure = failureOf(out.newton); !out.failure.empty()) return out;

  body.placeHeld(time + dt, true);
  const StepStages stages = stagesOf(body, env);
  if (stages.fused) {
    env.clock->measure(kForces, [&] { body.evaluate(time + dt, dt, parallelFor); });
    body.forcesCurrent = true;
    return out;
  }
  env.clock->measure(kGradients, [&] { body.computeGradients(parallelFor); });
  if (stages.flow) env.clock->measure(kFlow, [&] { body.computeFlow(dt, parallelFor); });
  env.clock->measure(kStresses, [&] { body.computeStresses(dt, parallelFor); });
  env.clock->measure(kForces, [&] { body.computeForces(time + dt, parallelFor); });
  body.forcesCurrent = true;
  return out;
}

}  // namespace pointbased
