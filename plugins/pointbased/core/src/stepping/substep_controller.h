// SPDX-License-Identifier: Apache-2.0
// The sizes of a body's steps, one after the other. Private to the core.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pointbased::detail {

/// Good steps after which a larger one is tried again, and during which a change counts as recent.
inline constexpr std::uint64_t kPatience = 256;

/// s: a free rigid body has no stable step, but what it meets is looked for once per substep.
inline constexpr double kFreeStep = 1e-3;

/// Remembers how the steps of a body were cut, so that their size does not go to and fro.
///
/// Each size of step keeps an energy of its own, (ω dt)²/4 of the exact one off in the fastest modes. One change moves
/// the energy once, changes in turn can pump it into what swings. A step is therefore divided no coarser than those
/// before it until fewer pieces would have done for kPatience steps (half as many: an eighth of that); and where
/// somebody changes the steps themselves, care() makes them so small that these energies are the same to 4 %.
class SubstepController {
 public:
  /// @param dt  s, size of the step that begins
  void begin(double dt) {
    if (last_ > 0.0 && std::abs(dt - last_) > 1e-9 * last_) {
      if (sinceChange_ < kPatience) restless_ = kPatience;
      sinceChange_ = 0;
    } else {
      ++sinceChange_;
      if (restless_ > 0) --restless_;
    }
    last_ = dt;
  }

  /// Part of the usual step to take: 1, less while somebody changes the size of the steps to and fro.
  [[nodiscard]] double care() const { return restless_ > 0 ? kRestless : 1.0; }

  /// Next substep, s, where `left` of a step of dt is left: an even piece of it, so that the last one is not a sliver.
  /// @param stable  s, no more than this
  [[nodiscard]] double piece(double left, double dt, double stable) const {
    const double present = std::ceil(left * pieces_ / dt * kRound);
    const double pieces =
        piecesOf(left, kRoom * stable) <= present ? present : std::max(piecesOf(left, stable), present);
    if (!(pieces > 1.0)) return left;
    return pieces < 1e15 ? left / pieces : stable;
  }

  /// Pieces of a step of dt that `stable` asks for: as many as before while they do.
  [[nodiscard]] double needed(double dt, double stable) const {
    const double usual = piecesOf(dt, stable);
    return usual > pieces_ && piecesOf(dt, kRoom * stable) <= pieces_ ? pieces_ : usual;
  }

  /// Even pieces of no more than `stable` that a step makes.
  [[nodiscard]] static double piecesOf(double step, double stable) { return std::ceil(step / stable * kRound); }

  /// @param pieces  of dt that would have done for the step that ends
  void end(double pieces) {
    // Twice as long steps are worth a change sooner.
    if (pieces < pieces_ && ++fewerWouldDo_ < (2.0 * pieces <= pieces_ ? kPatience / 8 : kPatience)) return;
    pieces_ = pieces;
    fewerWouldDo_ = 0;
  }

  /// Every number of it, for files.
  template <class Archive>
  void walk(Archive &archive) {
    archive(pieces_);
    archive(fewerWouldDo_);
    archive(last_);
    archive(sinceChange_);
    archive(restless_);
  }

 private:
  static constexpr double kRestless = 0.25;
  // Pieces may be that much longer than usual before there are more of them: 0.92 of what is stable instead of 0.8. A
  // step that is right at rest would be halved by every strain that stiffens the body by a per cent.
  static constexpr double kRoom = 1.15;
  static constexpr double kRound = 1.0 - 1e-9;  // what rounding adds is no further piece

  double pieces_ = 1.0;                                   // of a step at present
  std::uint64_t fewerWouldDo_ = 0;                        // steps in a row
  double last_ = 0.0;                                     // s
  std::uint64_t sinceChange_ = kPatience, restless_ = 0;  // steps since their size has changed, and left to be careful
};

}  // namespace pointbased::detail
