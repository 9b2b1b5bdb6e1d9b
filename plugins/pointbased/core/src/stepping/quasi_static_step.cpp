// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/number_text.h"
#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/stage_solution.h"

namespace pointbased {

using namespace detail;

namespace {

constexpr int kFlowRounds = 30;      // of a static equilibrium with plastic flow
constexpr int kHoldingRounds = 200;  // of a static equilibrium of what only contact holds
constexpr double kStride = 0.5;      // spacings that it may move in one of them
constexpr int kMostFailures = 6;     // of its rounds, for a held body
constexpr int kEasy = 15;            // Newton steps of a round after which the next one may be larger
constexpr double kHoldLess = 0.25;   // times after one that could have gone farther, of held bodies
constexpr double kNear = 0.1;        // spacings: a held body that moves no farther is solved as it is
constexpr double kHoldMore = 8.0;    // times the inertia after one that went too far or was not solved
constexpr double kLeaning = 1e-3;    // part of the loads that may still lean on inertia

// Σ of what pulls at phyxels at load factor `at`, N.
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

}  // namespace

ImplicitResult quasiStaticStep(Body &body, NewtonSolver &solver, const Environment &env, double from, double to,
                               const std::function<bool()> &shouldContinue) {
  State &state = body.state();
  const ParallelFor &parallelFor = *env.parallelFor;
  const double tolerance = newtonSettings(body, env, true).toleranceDisplacement;
  ImplicitResult out;
  const bool held = body.held() || body.foundation().settings().holds();
  // Held bodies are solved as they are, unless they buckle: then the next equilibrium may be far away, across states
  // that are none. They and the others lean on their own inertia, less and less, until they lie still.
  const double frequency = body.restFrequency();
  // What has no stiffness at all (a phyxel alone) is let down by a spacing at a time.
  const double leanFirst = frequency > 0.0 ? 1e-4 * frequency * frequency : env.gravity.norm() / body.rest().spacing;
  double holding = held ? 0.0 : leanFirst;
  // Contacts are known along a way of a spacing or so; what meets nothing may go as far as it likes.
  const double spacing = body.rest().spacing;
  const double stride = held && !env.contact() ? std::numeric_limits<double>::infinity() : kStride * spacing;
  const double loads = loadsOf(body, env, to);
  int flows = 0, failures = 0;
  for (int round = 0;; ++round) {
    const ImplicitStage stage{0.0, to, to - from, {}, {}, holding, 0.0};
    const std::vector<Vec3> before = state.displacements;
    const std::vector<Contact> contactsBefore = body.contact.active;
    out.newton = solveStage(body, solver, env, stage, {from, {}, shouldContinue, {}});
    double moved = 0.0, leaning = 0.0;  // m, N
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double way = (state.displacements[i] - before[i]).norm();
      moved = std::max(moved, way);
      leaning += body.masses()[i] * holding * way;
    }
    bool last = round + 1 >= kHoldingRounds;
    const bool buckles = held && !env.contact() && holding == 0.0 && !out.newton.good() &&
                         out.newton.outcome != NewtonOutcome::cancelled &&
                         out.newton.outcome != NewtonOutcome::notFinite;
    if (held && !out.newton.good() && ++failures > kMostFailures) last = true;
    if (buckles && !last) {
      state.displacements = before;
      body.contact.active = contactsBefore;
      holding = leanFirst;
      continue;
    }
    if (holding > 0.0 && !last && out.newton.outcome != NewtonOutcome::cancelled &&
        (!out.newton.good() || !(moved <= stride))) {
      state.displacements = before;
      body.contact.active = contactsBefore;
      holding *= kHoldMore;
      continue;
    }
    if (out.failure = failureOf(out.newton); !out.failure.empty()) return out;
    bool flowed = false;
    if (stagesOf(body, env).flow) {
      if (flows++ >= kFlowRounds) {
        out.failure = "plastic flow has not come to rest at load factor " + number(to, 4) +
                      "; the load is more than the body carries";
        return out;
      }
      // Without time all flow that is due takes place.
      flowed = body.computeFlow(1e6, parallelFor) > 0;
    }
    if (!flowed && (holding == 0.0 || (moved < tolerance && leaning <= kLeaning * loads))) break;
    if (last && held) {
      out.failure = "it has buckled, and still moves by " + number(1000.0 * moved, 4) + " mm after " +
                    std::to_string(kHoldingRounds) + " rounds at load factor " + number(to, 4);
      return out;
    }
    if (last) {
      out.failure = "nothing holds it against its loads at load factor " + number(to, 4) + " (it still moves " +
                    number(1000.0 * moved, 4) + " mm); add a [[fix]] or an obstacle below it";
      return out;
    }
    const bool isNear = moved < kNear * spacing;
    if (held && isNear)
      holding = 0.0;
    else if (held && out.newton.iterations <= kEasy)
      holding *= kHoldLess;
    else if (!held && moved < 0.5 * stride)
      holding *= moved < 0.01 * stride ? 0.125 : 0.5;
  }
  addStageForces(1.0, body.contact);
  std::fill(state.velocities.begin(), state.velocities.end(), Vec3::Zero());
  env.clock->measure(kGradients, [&] { body.computeGradients(parallelFor); });
  env.clock->measure(kStresses, [&] { body.computeStresses(0.0, parallelFor); });
  env.clock->measure(kForces, [&] { body.computeForces(to, parallelFor); });
  body.forcesCurrent = true;
  return out;
}

}  // namespace pointbased
