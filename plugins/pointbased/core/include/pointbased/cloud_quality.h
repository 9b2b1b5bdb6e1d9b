// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pointbased/rest_state.h"

namespace pointbased {

/// With fewer neighbours a fit has no redundancy; with more it is costly and blurred.
inline constexpr std::size_t kFewNeighbours = 12, kManyNeighbours = 100;
/// Fraction of the phyxels from which a warning is issued: edges and corners of a lattice have 11 and 7 neighbours.
inline constexpr double kUnusualPart = 0.25;
/// Phyxels closer than this fraction of the spacing coincide.
inline constexpr double kCoincident = 1e-6;

/// Anomalies in the neighbourhoods of a cloud. Lattices have none: their stencils are their cells.
struct CloudQuality {
  std::size_t few = 0, many = 0;  ///< phyxels with fewer than kFewNeighbours, more than kManyNeighbours
  std::size_t flat = 0;           ///< phyxels whose neighbours span a plane, a line or nothing
  std::size_t phyxels = 0;
  std::size_t coincident = 0;  ///< phyxels at the position of an earlier one; they remain, with their mass
  /// Largest condition number of the moment matrices Σ w d dᵀ, in the directions that their stencils span (directions
  /// below kMomentCutOff of the largest are excluded); 1 for an empty cloud and for lattices.
  double condition = 1.0;

  /// One sentence for the author of the cloud, with numbers and usual values; empty: no anomaly.
  [[nodiscard]] std::string warning() const;
};

/// One pass over all pairs. Any thread.
[[nodiscard]] CloudQuality inspectCloud(const RestState &rest);

/// Relative difference between the volume enclosed by a surface and the volume found inside that is accepted without a
/// warning: coarse samplings of thin parts reach 2 %.
inline constexpr double kVolumeMismatch = 0.05;

/// One sentence if the two volumes differ by more: the surface is open or intersects itself. Masses are those of the
/// volume of the surface. Empty: no anomaly.
[[nodiscard]] std::string volumeWarning(const RestState &rest);

/// Warning if the sampling has separated what the surface joins: there are more connected parts than pieces of the
/// surface. Otherwise empty. Such parts move apart, because nothing joins them.
[[nodiscard]] std::string tornWarning(const RestState &rest);

/// Warning if the sampling has joined separate pieces: there are fewer connected parts than pieces of the surface with
/// a volume of one cell or more (cavities do not count). Otherwise empty. Gaps thinner than about a sixteenth of the
/// spacing are not detected.
[[nodiscard]] std::string gluedWarning(const RestState &rest);

}  // namespace pointbased
