// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pointbased/error_estimate.h"

namespace pointbased {

/// Distance from a singular edge, in spacings, within which no stress is reported. A recovered strain is fitted to its
/// own cell and the adjacent cells, so beyond two spacings no fit contains a cell at the edge.
inline constexpr double kSingularSpacings = 2.0;

/// Locations where the stress of the continuum is unbounded, so that no sampling converges there.
struct SingularRegions {
  std::vector<std::uint8_t> points;  ///< [points] 1: within kSingularSpacings of one
  double volumePart = 0.0;           ///< 0 … 1, fraction of the body's volume in these points
  std::vector<std::size_t> fixes;    ///< fixes of the body with such an edge, ascending
  bool contact = false;              ///< the edge of a contact area
  bool grabs = false;                ///< patches that are grabbed
};

/// Finds edges of supports, of contact and of grabs.
///
/// A support ends where its region meets the free skin. Inside of a body only boxes have an edge; tissue is assumed to
/// be smooth, and the stress on the face of a bonded part is finite. Contact ends on the skin between points with and
/// without pressure. Edges of loads are not included (a jump of the traction leaves stress bounded), nor are edges
/// between two materials.
/// @param pressures  [phyxels] Pa, Diagnostics::contactPressures(); empty: nothing touches the body
[[nodiscard]] SingularRegions findSingularRegions(const Body &body, std::span<const double> pressures);

/// ErrorEstimate::relative of the points outside of singular locations only: their error over their own energy.
/// @param scratch  as left by the last estimateError() of this body
/// @return  0 … 1; 0 if no points remain, see SingularRegions::volumePart
[[nodiscard]] double relativeErrorOutside(const Body &body, const ErrorScratch &scratch,
                                          const SingularRegions &regions);

}  // namespace pointbased
