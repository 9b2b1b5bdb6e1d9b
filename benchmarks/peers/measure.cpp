// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/timing.h"

namespace peers {

double offeredStep(int index) { return kFrame * std::pow(2.0, -0.25 * index); }

bool isSound(const MovingBody &body, const Bounds &bounds) {
  const double farthest = body.largestDisplacement(), surplus = body.surplus();
  return farthest < 10.0 * bounds.length && surplus < 0.02 * bounds.energy;  // false for what is not a number
}

Cost run(const MakeBody &make, double dt, const Bounds &bounds, double budgetMs) {
  constexpr double kSeconds = 0.5;  // of simulated time: the first oscillation
  constexpr int kMinSteps = 8;
  constexpr int kWarmUp = 2;
  constexpr int kAtOnce = 8;  // steps between two readings of the clock
  Cost cost;
  const std::unique_ptr<MovingBody> body = make(dt);
  for (int i = 0; i < kWarmUp; ++i)
    if (!(body->step() > 0.0)) return cost;
  double spent = 0.0;
  int steps = 0;
  while (steps < kMinSteps || (cost.simulated < kSeconds && spent < budgetMs)) {
    const int many = spent > 0.0 && spent / steps > 10.0 ? 1 : kAtOnce;
    const double begin = bench::processor_ms();
    for (int i = 0; i < many; ++i) {
      const double advanced = body->step();
      if (!(advanced > 0.0)) return cost;
      cost.simulated += advanced;
    }
    spent += bench::processor_ms() - begin;
    steps += many;
    if (!isSound(*body, bounds)) return cost;
  }
  cost.stable = true;
  cost.dt = cost.simulated / steps;
  cost.stepMs = spent / steps;
  cost.perSecondMs = spent / cost.simulated;
  return cost;
}

Cost costAtLargestStep(const MakeBody &make, const Bounds &bounds, int hint, double budgetMs) {
  Cost best;
  int stable = -1, unstable = -1;
  const auto isStable = [&](int index) {
    Cost cost = run(make, offeredStep(index), bounds, budgetMs);
    cost.index = index;
    (cost.stable ? stable : unstable) = index;
    if (cost.stable) best = cost;
    return cost.stable;
  };
  // In growing strides away from the hint until it is bracketed, then by bisection.
  int index = std::clamp(hint, 0, kOfferedSteps - 1);
  for (int stride = 1;; stride *= 2) {
    const bool good = isStable(index);
    if (stable >= 0 && unstable >= 0) break;
    if (index == (good ? 0 : kOfferedSteps - 1)) break;
    index = std::clamp(good ? index - stride : index + stride, 0, kOfferedSteps - 1);
  }
  while (stable >= 0 && unstable >= 0 && stable - unstable > 1) isStable((stable + unstable) / 2);
  return best;
}

double relaxToRest(MovingBody &body, int mostSteps) {
  constexpr int kPause = 12;        // steps
  constexpr double kChange = 2e-4;  // of the displacement
  double kinetic = 0.0, before = 0.0;
  for (int i = 1; i <= mostSteps; ++i) {
    if (!(body.step() > 0.0)) break;
    const double now = body.kineticEnergy();
    if (!std::isfinite(now)) break;
    if (now < kinetic) {
      body.stop();
      kinetic = 0.0;
    } else {
      kinetic = now;
    }
    if (i % kPause != 0) continue;
    const double here = body.displacement()[2];
    if (std::abs(here - before) <= kChange * std::abs(here)) return here;
    before = here;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace peers
