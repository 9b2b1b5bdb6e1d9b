// SPDX-License-Identifier: Apache-2.0
// What a step costs on this machine.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "pointbased/body.h"

namespace pointbased {

/// Times of explicit substeps of boxes on a lattice, neo-Hookean, on the threads of the loops they were measured with.
struct MachineSpeed {
  static constexpr std::array<double, 4> kPoints{500.0, 2000.0, 8000.0, 24000.0};  ///< evaluation points, about
  std::array<double, 4> double_ns{};  ///< of a whole substep, per evaluation point
  std::array<double, 4> single_ns{};  ///< likewise, forces in single precision
  double contact_ns = 0.0;            ///< more of a substep, per point of contact, where there are walls
  double touch_ns = 0.0;              ///< likewise, per vertex of a skin that presses on that of another body
  double surfel_ns = 0.0;             ///< of an update of the skin for a screen, per vertex
  unsigned threads = 1;
  std::string kernels;  ///< instruction set

  [[nodiscard]] bool isKnown() const { return double_ns[0] > 0.0; }
  /// Of a substep, ns per evaluation point: between the sizes that were measured, beyond them as the nearest.
  [[nodiscard]] double perPoint(double points, Precision precision) const;
};

/// A machine to reckon with where results must not depend on the one at hand: one core of a server of 2020.
[[nodiscard]] MachineSpeed nominalSpeed();

/// Takes about a second.
/// @param threads  of parallelFor, as it is kept
[[nodiscard]] MachineSpeed measureSpeed(const ParallelFor &parallelFor, unsigned threads);

/// Whether figures that were kept are still those of this machine: same threads and kernels, and a body of 500 points
/// takes what they say to a third. Takes some ten milliseconds.
[[nodiscard]] bool isOfThisMachine(const MachineSpeed &kept, const ParallelFor &parallelFor, unsigned threads);

/// One line, and back; nothing where the text is not one.
[[nodiscard]] std::string textOf(const MachineSpeed &speed);
[[nodiscard]] std::optional<MachineSpeed> speedFrom(std::string_view text);

}  // namespace pointbased
