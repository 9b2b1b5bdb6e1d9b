// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "moving_body.h"

namespace peers {

/// Largest step tried: a frame.
inline constexpr double kFrame = 1.0 / 60.0;  // s
/// The steps tried are a frame divided by powers of 2^(1/4).
[[nodiscard]] double offeredStep(int index);
inline constexpr int kOfferedSteps = 60;

using MakeBody = std::function<std::unique_ptr<MovingBody>(double dt)>;

struct Bounds {
  double length = 0.0;  ///< m, of the body: nothing may move farther than ten times this, so a free fall may
  double energy = 0.0;  ///< J, weight times length: kinetic energy may exceed the work of gravity by a fiftieth of it
};

struct Cost {
  bool stable = false;
  double dt = 0.0;           ///< s, mean of the steps
  double stepMs = 0.0;       ///< processor time of one step, ms
  double perSecondMs = 0.0;  ///< processor time of a simulated second, ms
  double simulated = 0.0;    ///< s that were timed
  int index = 0;             ///< of the tried step
};

/// The body's state is finite, within bounds and has gained no energy.
[[nodiscard]] bool isSound(const MovingBody &body, const Bounds &bounds);

/// Runs a body from rest: two steps to warm up, then until half a second is simulated or `budgetMs` of processor time
/// spent (eight steps at least). Instability ends it: then `stable` is false.
[[nodiscard]] Cost run(const MakeBody &make, double dt, const Bounds &bounds, double budgetMs);

/// The cost at the largest of the tried steps that stays stable, searched from `hint` on.
[[nodiscard]] Cost costAtLargestStep(const MakeBody &make, const Bounds &bounds, int hint, double budgetMs);

/// Until the measured displacement is at rest: motion is stopped whenever the kinetic energy falls (kinetic damping).
/// @return vertical displacement, m; NaN: it does not come to rest within `mostSteps`
[[nodiscard]] double relaxToRest(MovingBody &body, int mostSteps);

}  // namespace peers
