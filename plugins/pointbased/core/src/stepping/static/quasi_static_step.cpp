// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/implicit/island_step.h"
#include "stepping/implicit/stage_solution.h"

namespace pointbased {
namespace detail {
namespace {

constexpr int kFlowRounds = 30;         // of a static equilibrium with plastic flow
constexpr int kMaxInertiaRounds = 200;  // of a static equilibrium that is held by contact only
constexpr double kStride = 0.5;         // spacings that a body may move in one of them
constexpr int kMaxFailures = 6;         // of its rounds, for a held body
constexpr int kEasyIterations = 15;     // Newton steps of a round up to which the next one may be larger
// factor of the inertia after a round that could have moved farther, for held bodies
constexpr double kInertiaDecrease = 0.25;
constexpr double kNear = 0.1;              // spacings: a held body that moves less is solved without inertia
constexpr double kInertiaIncrease = 8.0;   // factor of the inertia after a round that moved too far or failed
constexpr double kInertiaFraction = 1e-3;  // fraction of the loads that inertia may still support

// Σ of the magnitudes of the loads on phyxels at load factor `at`, N.
double loadsOf(Body &body, const Environment &env, double at) {
  std::vector<Vec3> forces(body.rest().phyxelCount());
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = body.weights()[i] * env.gravity;
  const BoundaryConditions &conditions = body.rest().conditions;
  for (std::size_t l = 0; l < conditions.loads.size(); ++l)
    addLoadForces(conditions.loads[l], conditions.loaded[l], body.factor(conditions.loads[l].ramp, at),
                  body.state().displacements, forces);
  double sum = 0.0;
  for (const Vec3 &f : forces) sum += f.norm();
  return sum;
}

// One body of the step.
struct Part {
  Part(const StepPart &part, bool isHeld) : body(part.body), env(part.environment), held(isHeld) {
    // A body without stiffness (a single phyxel) moves by one spacing at a time.
    const double frequency = body->restFrequency();
    firstInertia = frequency > 0.0 ? 1e-4 * frequency * frequency : env->gravity.norm() / body->rest().spacing;
  }
  void save() {
    before = body->state().displacements;
    contactsBefore = body->contact.active;
  }
  void restore() {
    body->state().displacements = before;
    body->contact.active = contactsBefore;
  }
  Body *body;
  const Environment *env;
  bool held;
  double firstInertia = 0.0;  // 1/s²
  std::vector<Vec3> before;
  std::vector<Contact> contactsBefore;
  ImplicitStage stage;
};

}  // namespace

ImplicitResult quasiStaticStep(std::span<const StepPart> stepParts, StageCoupling *coupling, NewtonSolver &solver,
                               double from, double to, const std::function<bool()> &shouldContinue) {
  std::vector<Part> parts;
  for (const StepPart &part : stepParts)
    parts.emplace_back(part, part.body->held() || part.body->foundation().settings().holds() ||
                                 (coupling && coupling->holds(*part.body)));
  double tolerance = std::numeric_limits<double>::infinity(), spacing = tolerance, firstInertia = 0.0, loads = 0.0;
  bool held = true, touches = coupling && coupling->hasPairs();
  for (Part &part : parts) {
    tolerance = std::min(tolerance, newtonSettings(*part.body, *part.env, true).toleranceDisplacement);
    spacing = std::min(spacing, part.body->rest().spacing);
    firstInertia = std::max(firstInertia, part.firstInertia);
    loads += loadsOf(*part.body, *part.env, to);
    held = held && part.held;
    touches = touches || part.env->contact();
  }
  ImplicitResult out;
  // Held bodies are solved without inertia unless they buckle: then the next equilibrium may be far away, beyond states
  // that are no equilibria. They, and bodies that are not held, are supported by their own inertia, which is reduced
  // until they are at rest.
  double pseudoInertia = held ? 0.0 : firstInertia;
  // Contacts are known along a path of about a spacing; without contact the displacement is not limited.
  const double stride = held && !touches ? std::numeric_limits<double>::infinity() : kStride * spacing;
  int flows = 0, failures = 0;
  for (int round = 0;; ++round) {
    std::vector<StageMember> members;
    StageCoupling::Contacts pairsBefore;
    if (coupling) pairsBefore = coupling->contacts();
    for (Part &part : parts) {
      part.stage = {0.0, to, to - from, {}, {}, held || !part.held ? pseudoInertia : 0.0, 0.0};
      part.save();
      members.push_back({part.body, part.env, &part.stage});
    }
    if (coupling) coupling->beginSums();
    out.newton = solveStage(members, coupling, solver, {from, {}, shouldContinue, {}, 1.0}).newton;
    double moved = 0.0, inertialForces = 0.0;  // m, N
    for (const Part &part : parts)
      for (std::size_t i = 0; i < part.before.size(); ++i) {
        const double displacement = (part.body->state().displacements[i] - part.before[i]).norm();
        moved = std::max(moved, displacement);
        inertialForces += part.body->masses()[i] * part.stage.holding * displacement;
      }
    const auto restore = [&] {
      for (Part &part : parts) part.restore();
      if (coupling) coupling->setContacts(pairsBefore);
    };
    bool last = round + 1 >= kMaxInertiaRounds;
    const bool buckles = held && !touches && pseudoInertia == 0.0 && !out.newton.good() &&
                         out.newton.outcome != NewtonOutcome::cancelled &&
                         out.newton.outcome != NewtonOutcome::notFinite;
    if (held && !out.newton.good() && ++failures > kMaxFailures) last = true;
    if (buckles && !last) {
      restore();
      pseudoInertia = firstInertia;
      continue;
    }
    if (pseudoInertia > 0.0 && !last && out.newton.outcome != NewtonOutcome::cancelled &&
        (!out.newton.good() || !(moved <= stride))) {
      restore();
      pseudoInertia *= kInertiaIncrease;
      continue;
    }
    if (out.failure = failureOf(out.newton); !out.failure.empty()) return out;
    bool flowed = false;
    for (const Part &part : parts) {
      if (!stagesOf(*part.body, *part.env).flow) continue;
      if (flows++ >= kFlowRounds * static_cast<int>(parts.size())) {
        out.failure = "plastic flow has not come to rest at load factor " + number(to, 4) +
                      "; the load is more than the body carries";
        return out;
      }
      // In a static solution all pending flow takes place.
      flowed = part.body->computeFlow(1e6, *part.env->parallelFor) > 0 || flowed;
    }
    if (!flowed && (pseudoInertia == 0.0 || (moved < tolerance && inertialForces <= kInertiaFraction * loads))) break;
    if (last && held) {
      out.failure = "it has buckled, and still moves by " + number(1000.0 * moved, 4) + " mm after " +
                    std::to_string(kMaxInertiaRounds) + " rounds at load factor " + number(to, 4);
      return out;
    }
    if (last) {
      out.failure = "nothing holds it against its loads at load factor " + number(to, 4) + " (it still moves " +
                    number(1000.0 * moved, 4) + " mm); add a [[fix]] or an obstacle below it";
      return out;
    }
    const bool isNear = moved < kNear * spacing;
    if (held && isNear)
      pseudoInertia = 0.0;
    else if (held && out.newton.iterations <= kEasyIterations)
      pseudoInertia *= kInertiaDecrease;
    else if (!held && moved < 0.5 * stride)
      pseudoInertia *= moved < 0.01 * stride ? 0.125 : 0.5;
  }
  for (const Part &part : parts) {
    Body &body = *part.body;
    const Environment &env = *part.env;
    const ParallelFor &parallelFor = *env.parallelFor;
    addStageForces(1.0, body.contact);
    std::fill(body.state().velocities.begin(), body.state().velocities.end(), Vec3::Zero());
    if (body.vectorised()) {
      env.clock->measure(kForces, [&] { body.evaluate(to, 0.0, parallelFor); });
    } else {
      env.clock->measure(kGradients, [&] { body.computeGradients(parallelFor); });
      env.clock->measure(kStresses, [&] { body.computeStresses(0.0, parallelFor); });
      env.clock->measure(kForces, [&] { body.computeForces(to, parallelFor); });
    }
    body.forcesCurrent = true;
  }
  return out;
}

}  // namespace detail

ImplicitResult quasiStaticStep(Body &body, NewtonSolver &solver, const Environment &env, double from, double to,
                               const std::function<bool()> &shouldContinue) {
  const detail::StepPart alone{&body, &env};
  return detail::quasiStaticStep(std::span<const detail::StepPart>(&alone, 1), nullptr, solver, from, to,
                                 shouldContinue);
}

}  // namespace pointbased
