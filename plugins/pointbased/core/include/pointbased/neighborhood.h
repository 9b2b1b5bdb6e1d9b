// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/stencil.h"
#include "pointbased/types.h"

namespace pointbased {

/// Rule by which a phyxel chooses its neighbours.
struct NeighborChoice {
  int count = 0;         ///< > 0: number of nearest ones, 3 … 500 (26 on a lattice); 0: by support
  double support = 1.8;  ///< radius in spacings, 1.01 … 6; below 1.8 a lattice retains neighbours along its axes only
};

struct Neighborhoods {
  Csr neighbors;                     ///< symmetric, ascending, without the phyxel itself
  std::vector<double> supportRadii;  ///< h per phyxel, m
};

/// The support ends beyond the farthest chosen neighbour: a weight that vanishes exactly there would drop a whole shell
/// of a lattice.
inline constexpr double kSupportMargin = 1.1;

/// k-d tree search. A pair is included if either of the two has chosen the other.
/// @param spacing  typical distance of phyxels, m (the unit of `support`)
[[nodiscard]] Neighborhoods findNeighborhoods(std::span<const Vec3> positions, const NeighborChoice &choice,
                                              double spacing, const ParallelFor &parallelFor);

}  // namespace pointbased
