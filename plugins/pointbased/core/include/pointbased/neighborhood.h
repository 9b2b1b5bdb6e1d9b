// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// How a phyxel chooses its neighbours.
struct NeighborChoice {
  int count = 0;         ///< > 0: so many nearest ones, 3 … 500 (26 on a lattice); 0: by support
  double support = 1.8;  ///< radius in spacings, 1.01 … 6; below 1.8 a lattice keeps only its axes
};

struct Neighborhoods {
  Csr neighbors;                     ///< symmetric, ascending, without the phyxel itself
  std::vector<double> supportRadii;  ///< h per phyxel, m
};

/// The support ends beyond the farthest chosen neighbour: a weight that vanishes exactly there would drop a whole shell
/// of a lattice.
inline constexpr double kSupportMargin = 1.1;

/// k-d tree search. A pair is in if either of the two chose it.
/// @param spacing  typical distance of phyxels, m (the unit of `support`)
[[nodiscard]] Neighborhoods findNeighborhoods(std::span<const Vec3> positions, const NeighborChoice &choice,
                                              double spacing, const ParallelFor &parallelFor);

}  // namespace pointbased
