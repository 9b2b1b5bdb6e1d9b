// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "pointbased/body.h"

namespace pointbased {

/// Result of a pass of the guard over the phyxels.
struct GuardView {
  bool finite = true;
  /// m/s, largest speed relative to the body's mean velocity, weighted with the influence of the phyxel on the body
  /// (RestState::maxInfluence)
  double fastest = 0.0;
  Index fastestPhyxel = 0;
  double meanSpeed = std::numeric_limits<double>::infinity();  ///< m/s, of the body
};

/// Full and exact check.
[[nodiscard]] GuardView fullCheck(const Body &body);

/// First check of every step, in one pass over the state that costs less than a percent of the elastic stages.
struct QuickCheckResult {
  bool finite = true;       ///< including squares, as used in energies: 1e300 m/s counts as infinite
  double speedBound = 0.0;  ///< m/s, upper bound of the speed of all phyxels relative to the body's mean velocity
};
[[nodiscard]] QuickCheckResult quickCheck(const Body &body);
/// Same for one field, including its squares.
[[nodiscard]] bool isFinite(std::span<const Vec3> field);

/// For a state that is not finite, in the sense of QuickCheckResult: the first phyxel with a non-finite displacement or
/// velocity.
[[nodiscard]] GuardFinding firstNonFinite(const Body &body);

/// Steps between two energy checks of bodies that nothing drives, whose energy must not grow. Energies cost about half
/// a force evaluation.
inline constexpr std::uint64_t kEnergyInterval = 128;

/// Energies of a body, or of several, for comparison by the guard; J.
struct EnergyLevel {
  double total = 0.0;              ///< including the potential of gravity, dead loads, supports and foundation
  double kinetic = 0.0;            ///< J
  double stored = 0.0;             ///< J, elastic
  double depenetrationWork = 0.0;  ///< J, added by depenetration since ContactState::depenetrationMoment was zero
  double roundOff = 0.0;           ///< J, of `stored`
  void add(const EnergyLevel &other);
};
[[nodiscard]] EnergyLevel energyLevel(const Body &body, const Vec3 &gravity);

/// Permitted growth of the total between two checks, as a fraction of the larger of kinetic and elastic energy:
/// velocity Verlet changes it by (ω dt)²/4, at most 16 % of the share of the fastest mode, contact by depenetration.
inline constexpr double kEnergyGrowth = 0.25;
/// Checks for spurious energy growth.
/// @return  description of the defect; empty: none
[[nodiscard]] std::string energyGrowth(const EnergyLevel &before, const EnergyLevel &now);
/// Remedy for it.
inline constexpr const char *kLessEnergy =
    "a smaller solver.dt, solver.integrator = \"implicit\" or more material.viscosity";

}  // namespace pointbased
