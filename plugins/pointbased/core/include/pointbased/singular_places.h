// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pointbased/error_estimate.h"

namespace pointbased {

/// Spacings around a singular edge in which stress has no figure. A recovered strain is fitted to its own cell and the
/// cells beside it, so beyond two spacings no fit contains a cell at the edge.
inline constexpr double kSingularSpacings = 2.0;

/// Where the stress of the continuum is unbounded, so that no sampling converges there.
struct SingularPlaces {
  std::vector<std::uint8_t> points;  ///< [points] 1: within kSingularSpacings of one
  double volumePart = 0.0;           ///< 0 … 1, of the body: in these points
  std::vector<std::size_t> fixes;    ///< the body's fixes that have such an edge, ascending
  bool contact = false;              ///< the edge of an area that touches something
  bool hands = false;                ///< patches that hands hold
};

/// Finds edges of supports, of contact and of what hands hold.
///
/// A support ends where its region meets the free skin. Inside of a body only boxes have an edge; tissue is taken to be
/// smooth, and the stress on the face of a bonded part is finite. Contact ends on the skin between pressed and free points.
/// Edges of loads are not among them (a jump of the traction leaves stress bounded), nor are edges between two materials.
/// @param pressures  [phyxels] Pa, Simulator::contactPressures(); empty: nothing touches the body
[[nodiscard]] SingularPlaces findSingularPlaces(const Body &body, std::span<const double> pressures);

/// ErrorEstimate::relative of the points outside of singular places alone: their error over their own energy.
/// @param scratch  as the last estimateError() of this body left it
/// @return  0 … 1; 0 where no points are left, see SingularPlaces::volumePart
[[nodiscard]] double relativeErrorOutside(const Body &body, const ErrorScratch &scratch, const SingularPlaces &places);

}  // namespace pointbased
