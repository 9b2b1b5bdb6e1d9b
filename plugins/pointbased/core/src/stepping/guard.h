// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "pointbased/body.h"

namespace pointbased {

/// What the guard sees on the way over the phyxels.
struct GuardView {
  bool finite = true;
  /// m/s, largest speed relative to the body's mean velocity at which a phyxel takes some of the body along
  /// (RestState::maxInfluence)
  double fastest = 0.0;
  Index fastestPhyxel = 0;
  double meanSpeed = std::numeric_limits<double>::infinity();  ///< m/s, of the body
};

/// Everything, exactly.
[[nodiscard]] GuardView fullCheck(const Body &body);

/// What every step asks first, in one pass over the state that costs less than a percent of the elastic stages.
struct QuickCheckResult {
  bool finite = true;       ///< squares included, because energies are made of them: 1e300 m/s is as good as infinite
  double speedBound = 0.0;  ///< m/s: no phyxel is faster relative to the body's mean velocity
};
[[nodiscard]] QuickCheckResult quickCheck(const Body &body);
/// Of one field, likewise with its squares.
[[nodiscard]] bool isFinite(std::span<const Vec3> field);

/// Of a state that is not finite, in the sense of QuickCheckResult: the first phyxel whose displacement or velocity is
/// not.
[[nodiscard]] GuardFinding firstNonFinite(const Body &body);

/// Steps between two looks at the energy of bodies that nothing drives, which may not grow: energies cost about half a
/// force evaluation.
inline constexpr std::uint64_t kEnergyInterval = 128;

/// Energies of a body, or of several, as the guard compares them; J.
struct EnergyLevel {
  double total = 0.0;     ///< with the potential of gravity, dead loads, supports and foundation
  double kinetic = 0.0;   ///< J
  double stored = 0.0;    ///< J, elastic
  double lifted = 0.0;    ///< J, by what contact has led out of obstacles since ContactState::ledOut was zero
  double roundOff = 0.0;  ///< J, of `stored`
  void add(const EnergyLevel &other);
};
[[nodiscard]] EnergyLevel energyLevel(const Body &body, const Vec3 &gravity);

/// Part of the larger of kinetic and elastic energy that the sum may grow by between two looks: velocity Verlet moves
/// it by (ω dt)²/4 at most 16 % of the fastest mode's share, contact by what leads out of a penetration.
inline constexpr double kEnergyGrowth = 0.25;
/// Whether energy has come from nothing. @return what is wrong; empty: nothing
[[nodiscard]] std::string energyGrowth(const EnergyLevel &before, const EnergyLevel &now);
/// What helps then.
inline constexpr const char *kLessEnergy =
    "a smaller solver.dt, solver.integrator = \"implicit\" or more material.viscosity";

}  // namespace pointbased
