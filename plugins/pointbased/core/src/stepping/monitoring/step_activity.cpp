// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/step_activity.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "stepping/monitoring/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr double kNearlyIncompressible = 0.49;
constexpr std::size_t kManyPhyxels = 2000;  // phyxels of an implicit step
constexpr double kMuchCheaper = 0.5;
constexpr double kLittle = 0.1;       // fraction of a budget: if forces take less, they are not the cause
constexpr double kPartAimedAt = 0.5;  // fraction of a budget: the duration of a step depends on the deformation

}  // namespace

std::string suggestRemedy(const Body &body, const WorldSettings &world, Integrator integrator) {
  double poisson = 0.0, modulus = 0.0;
  for (const Material &m : body.constitution().materials) {
    poisson = std::max(poisson, m.poissonRatio);
    modulus = std::max(modulus, m.youngsModulus);
  }
  const std::size_t phyxels = body.rest().phyxelCount();
  const bool isExplicit = integrator == Integrator::explicitVerlet, isStatic = integrator == Integrator::quasiStatic;
  const std::string name = "body '" + body.name() + "': ";
  if (poisson >= kNearlyIncompressible)
    return name + "nearly incompressible (ν " + number(poisson) + "): a lower ν" +
           (isExplicit || isStatic ? "" : ", or explicit steps,") + " would help";
  if (body.isFreeRigid()) return name + "rigid; what it touches or is attached to sets its steps";
  if (isExplicit) {
    const double stable = kStepSafety * body.stableStepAtRest();
    return name + "steps of no more than " + number(stable) + " s are stable (E " + number(modulus) + " Pa, spacing " +
           number(1e3 * body.rest().spacing) + " mm): fewer phyxels or a smaller E would help";
  }
  const StepCost cost = predictCost(body, world.dt);
  const bool explicitIsCheap = !isStatic && cost.explicitEvaluations < kMuchCheaper * cost.implicitEvaluations;
  if (phyxels > kManyPhyxels || explicitIsCheap)
    return name + std::to_string(phyxels) + " phyxels in " + (isStatic ? "a load step" : "implicit steps") + ": fewer" +
           (explicitIsCheap ? ", or explicit steps," : "") + " would help";
  return name + (isStatic ? "the load is large for one step: more load steps would help"
                          : "it deforms much in one step: a smaller time step would help");
}

std::string suggestAffordableStep(const Body &body, Integrator integrator, const Effort &effort) {
  const std::size_t phyxels = body.rest().phyxelCount();
  const bool isExplicit = integrator == Integrator::explicitVerlet, isStatic = integrator == Integrator::quasiStatic;
  const double dt = isStatic ? kImplicitStep : effort.dt;  // a load step costs about as much as a time step
  const double stable = kStepSafety * std::min(body.stableStepAtRest(), body.stableStep());
  const double explicitTime = predictCost(stable, dt, body.constitution()).explicitEvaluations * dt * effort.evaluation;
  const double goal = kPartAimedAt * effort.budget;
  const std::string measured =
      " (measured: " + number(1e3 * effort.evaluation, 2) + " ms per evaluation of the forces)";
  std::string text = "body '" + body.name() + "', " + std::to_string(phyxels) + " phyxels, ";
  if (isExplicit && explicitTime < kLittle * effort.budget)
    return text + "was not done after " + number(effort.budget, 2) + " s, though its forces take only " +
           number(explicitTime, 2) + " s for a step of " + number(dt) + " s" + measured +
           ": the rest is contact, or a busy machine. A coarser surface, no contact where " +
           "it does not matter (contact.pair, contact.self), or a larger solver.step_budget would fit";
  if (isExplicit)
    return text + "would take " + number(explicitTime, 2) + " s for a step of " + number(dt) + " s" + measured +
           "; solver.dt = " + number(dt * std::min(0.5, goal / explicitTime), 2) +
           ", fewer phyxels or a smaller E would fit";
  text += "was not solved after " + std::to_string(effort.newtonSteps) + " Newton step" +
          (effort.newtonSteps == 1 ? "" : "s") + " and " + std::to_string(effort.iterations) +
          " iterations of the linear solver. What would fit" + measured + ": ";
  std::string offers;
  const auto offer = [&offers](const std::string &what) { offers += (offers.empty() ? "" : "; or ") + what; };
  if (!isStatic && explicitTime <= goal)
    offer("solver.integrator = \"explicit\", " + number(explicitTime, 2) + " s for a step of " + number(dt) + " s");
  // It has used the whole budget and was not done.
  const double implicitTime =
      std::max(effort.budget, predictCost(body, dt).implicitEvaluations * dt * effort.evaluation);
  const double count = std::max(50.0, static_cast<double>(phyxels) * goal / implicitTime);
  offer("sampling.count = " + std::to_string(10 * std::llround(0.1 * count)) + " or less");
  double poisson = 0.0;
  for (const Material &m : body.constitution().materials) poisson = std::max(poisson, m.poissonRatio);
  if (poisson >= kNearlyIncompressible) offer("a Poisson's ratio below " + number(kNearlyIncompressible));
  if (isStatic)
    offer("more solver.load_steps");
  else
    offer("solver.dt = " + number(0.25 * dt, 2));
  return text + offers;
}

}  // namespace pointbased::detail
