// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

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

/// Watches the energy of a body that nothing drives: it may not grow. Asked every kEnergyInterval steps, because
/// energies cost about half a force evaluation.
class EnergyWatch {
 public:
  static constexpr std::uint64_t kEnergyInterval = 128;
  /// Part of the larger of kinetic and elastic energy that the sum may grow by between two looks: velocity Verlet moves
  /// it by (ω dt)²/4 at most 16 % of the fastest mode's share, contact by what leads out of a penetration.
  static constexpr double kGrowth = 0.25;

  /// @param driven  loads that change, moving supports or obstacles, a hand: then the energy may grow
  /// @return what is wrong, if it has grown
  [[nodiscard]] std::optional<GuardFinding> look(const Body &body, const Vec3 &gravity, bool driven);
  void forget() { known_ = false; }

 private:
  bool known_ = false;
  double total_ = 0.0, scale_ = 0.0;
};

}  // namespace pointbased
