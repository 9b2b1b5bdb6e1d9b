// SPDX-License-Identifier: Apache-2.0
// Step-size control of a body. Private to the core.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pointbased::detail {

/// Successful steps after which a larger one is tried, and during which a change counts as recent.
inline constexpr std::uint64_t kPatience = 256;

/// s: a free rigid body has no stable step, but its contacts are searched once per substep.
inline constexpr double kFreeStep = 1e-3;

/// Stores how the steps of a body were divided, so that their size does not oscillate.
///
/// Each step size conserves a different energy, which differs from the exact one by (ω dt)²/4 in the fastest modes. A
/// single change shifts the energy once; alternating changes can pump energy into oscillations. A step is therefore
/// divided no more coarsely than the previous ones until fewer pieces would have sufficed for kPatience steps (half as
/// many: an eighth of that). If the caller keeps changing the step size, stepSafety() reduces the substeps such that
/// these energies agree to 4 %.
class SubstepController {
 public:
  /// @param dt  s, size of the new step
  void begin(double dt) {
    if (last_ > 0.0 && std::abs(dt - last_) > 1e-9 * last_) {
      if (sinceChange_ < kPatience) unsteadySteps_ = kPatience;
      sinceChange_ = 0;
    } else {
      ++sinceChange_;
      if (unsteadySteps_ > 0) --unsteadySteps_;
    }
    last_ = dt;
  }

  /// Factor of the usual substep: 1, less while the caller changes the step size back and forth.
  [[nodiscard]] double stepSafety() const { return unsteadySteps_ > 0 ? kUnsteadyFactor : 1.0; }

  /// Next substep, s, with `left` remaining of a step of dt: an even division of it, so that the last one is not a
  /// sliver.
  /// @param stable  s, upper limit
  [[nodiscard]] double nextSubstep(double left, double dt, double stable) const {
    const double present = std::ceil(left * pieces_ / dt * kRound);
    const double pieces =
        piecesOf(left, kTolerance * stable) <= present ? present : std::max(piecesOf(left, stable), present);
    if (!(pieces > 1.0)) return left;
    return pieces < 1e15 ? left / pieces : stable;
  }

  /// Number of pieces of a step of dt that `stable` requires: the previous number as long as it is sufficient.
  [[nodiscard]] double requiredPieces(double dt, double stable) const {
    const double usual = piecesOf(dt, stable);
    return usual > pieces_ && piecesOf(dt, kTolerance * stable) <= pieces_ ? pieces_ : usual;
  }

  /// Number of even pieces of a step, each at most `stable`.
  [[nodiscard]] static double piecesOf(double step, double stable) { return std::ceil(step / stable * kRound); }

  /// @param pieces  of dt that would have sufficed for the completed step
  void end(double pieces) {
    // Half as many pieces justify an earlier change.
    if (pieces < pieces_ && ++fewerSufficed_ < (2.0 * pieces <= pieces_ ? kPatience / 8 : kPatience)) return;
    pieces_ = pieces;
    fewerSufficed_ = 0;
  }

  /// Visits every number, for saved states.
  template <class Archive>
  void walk(Archive &archive) {
    archive(pieces_);
    archive(fewerSufficed_);
    archive(last_);
    archive(sinceChange_);
    archive(unsteadySteps_);
  }

 private:
  static constexpr double kUnsteadyFactor = 0.25;
  // Substeps may be longer than usual by this factor before their number increases: 0.92 of the stable step instead of
  // 0.8. Otherwise a step that is suitable at rest would be halved by every strain that stiffens the body by a per
  // cent.
  static constexpr double kTolerance = 1.15;
  static constexpr double kRound = 1.0 - 1e-9;  // rounding does not add a piece

  double pieces_ = 1.0;              // of a step at present
  std::uint64_t fewerSufficed_ = 0;  // steps in a row
  double last_ = 0.0;                // s
  // steps since the last change of their size, and remaining steps with smaller substeps
  std::uint64_t sinceChange_ = kPatience, unsteadySteps_ = 0;
};

}  // namespace pointbased::detail
