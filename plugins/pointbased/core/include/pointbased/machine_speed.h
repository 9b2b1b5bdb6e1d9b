// SPDX-License-Identifier: Apache-2.0
// Cost of a step on this machine.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "pointbased/body.h"

namespace pointbased {

/// Times of explicit substeps of boxes on a lattice, neo-Hookean, with the number of threads of the measured loops.
struct MachineSpeed {
  static constexpr std::array<double, 4> kPoints{500.0, 2000.0, 8000.0, 24000.0};  ///< evaluation points, about
  std::array<double, 4> double_ns{};  ///< of a whole substep, per evaluation point
  std::array<double, 4> single_ns{};  ///< as double_ns, with forces in single precision
  double contact_ns = 0.0;            ///< additional per substep and contact point, if there are walls
  double touch_ns = 0.0;   ///< additional per substep and vertex of a skin that presses on that of another body
  double surfel_ns = 0.0;  ///< per vertex, of an update of the skin for display
  unsigned threads = 1;
  std::string kernels;  ///< instruction set

  [[nodiscard]] bool isKnown() const { return double_ns[0] > 0.0; }
  /// Time of a substep, ns per evaluation point: interpolated between the measured sizes, beyond them that of the
  /// nearest.
  [[nodiscard]] double perPoint(double points, Precision precision) const;
};

/// A nominal machine for results that must not depend on the present one: one core of a server of 2020.
[[nodiscard]] MachineSpeed nominalSpeed();

/// Measures the present machine; takes about a second.
/// @param threads  of parallelFor, as stored in the result
[[nodiscard]] MachineSpeed measureSpeed(const ParallelFor &parallelFor, unsigned threads);

/// Whether stored figures are valid for this machine: same threads and kernels, and a body of 500 points takes the
/// stored time to within a third. Takes some ten milliseconds.
[[nodiscard]] bool matchesThisMachine(const MachineSpeed &kept, const ParallelFor &parallelFor, unsigned threads);

/// Conversion to one line of text and back; empty if the text is not such a line.
[[nodiscard]] std::string textOf(const MachineSpeed &speed);
[[nodiscard]] std::optional<MachineSpeed> speedFrom(std::string_view text);

}  // namespace pointbased
