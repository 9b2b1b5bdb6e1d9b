// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pointbased/rest_state.h"

namespace pointbased {

/// Fewer neighbours than this leave a fit without reserve, more than the other make it costly and blur it.
inline constexpr std::size_t kFewNeighbours = 12, kManyNeighbours = 100;
/// A part of the phyxels that is worth a warning: edges and corners of a lattice have 11 and 7 neighbours.
inline constexpr double kUnusualPart = 0.25;
/// Phyxels closer than this part of the spacing lie at the same place.
inline constexpr double kCoincident = 1e-6;

/// What is unusual about the neighbourhoods of a cloud. Of a lattice nothing is: its stencils are its cells.
struct CloudQuality {
  std::size_t few = 0, many = 0;  ///< phyxels with fewer than kFewNeighbours, more than kManyNeighbours
  std::size_t flat = 0;           ///< phyxels whose neighbours span a plane, a line or nothing
  std::size_t phyxels = 0;
  std::size_t coincident = 0;  ///< phyxels that lie where one before them lies; they stay, with their mass
  /// Largest condition number of the moment matrices Σ w d dᵀ, in the directions that their stencils span (those below
  /// kMomentCutOff of the largest do not count); 1 for an empty cloud and for lattices.
  double condition = 1.0;

  /// One sentence for whoever made the cloud, with numbers and what is usual; empty: nothing to tell.
  [[nodiscard]] std::string warning() const;
};

/// One pass over all pairs. Any thread.
[[nodiscard]] CloudQuality inspectCloud(const RestState &rest);

/// Part by which the volume that a surface encloses and the one that is found inside may differ without a warning:
/// coarse samplings of thin parts come to 2 %.
inline constexpr double kVolumeMismatch = 0.05;

/// One sentence where the two volumes differ by more: a surface that is open or goes through itself. Masses are those
/// of the surface's volume. Empty: nothing to tell.
[[nodiscard]] std::string volumeWarning(const RestState &rest);

/// The sampling has torn what its surface holds together: it has more connected parts than the surface has pieces. Else
/// empty. These parts move apart, because nothing joins them.
[[nodiscard]] std::string tornWarning(const RestState &rest);

/// The sampling has joined what lies apart: fewer connected parts than its surface has pieces of a cell's volume or
/// more (hollows do not count). Else empty. Gaps thinner than about a sixteenth of the spacing are not seen.
[[nodiscard]] std::string gluedWarning(const RestState &rest);

}  // namespace pointbased
