// SPDX-License-Identifier: Apache-2.0
#include "stepping/step_activity.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "stepping/step_cost.h"

namespace pointbased::detail {
namespace {

constexpr double kNearlyIncompressible = 0.49;
constexpr std::size_t kManyPhyxels = 2000;  // of an implicit step
constexpr double kMuchCheaper = 0.5;

}  // namespace

std::string whatWouldHelp(const Body &body, const WorldSettings &world, Integrator integrator) {
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

}  // namespace pointbased::detail
