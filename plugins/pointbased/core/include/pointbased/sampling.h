// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pointbased/body_shape.h"
#include "pointbased/types.h"

namespace pointbased {

struct Sampling {
  double spacing = 0.0;  ///< of the lattice, m; 0: from count
  std::size_t count = 1000;
};

/// Phyxels of a body, sorted in space.
struct PhyxelCloud {
  double spacing = 0.0;              ///< m
  std::vector<Vec3> positions;       ///< m
  std::vector<double> volumes;       ///< m³; their sum is the body's volume
  std::vector<double> contactRadii;  ///< m: distance to the surface, at most half a spacing
  double countedVolume = 0.0;        ///< m³, volume found inside, before scaling; 0: not determined
};

/// Return false to cancel.
using SamplingProgress = std::function<bool(double fraction)>;

inline constexpr std::size_t kMaximumPhyxels = 2'000'000;

/// Default number of phyxels of a body: such that their distance is at most half of its thickness, at least 1000 and at
/// most 4000.
///
/// The thickness is t = 2V/A (of a sheet its thickness, of a tube the radius). A lattice of spacing d over a sheet has
/// about (V + A d)/d³ points: t/d + 2 planes of A/(2d²) each; with d = t/2 that is 2A³/V². Compact organs (a ball: 226,
/// a cube: 432) get 1000. If 4000 is still too coarse, the represented part, the error estimate or a refusal indicates
/// it.
/// @param volume  m³, > 0
/// @param area    of the surface, m²
[[nodiscard]] std::size_t automaticCount(double volume, double area);

/// Phyxels on a regular lattice inside the body, each with the volume of the part of the body that is nearest to it.
///
/// The part is measured by counting points of a finer lattice inside the body. Points near the surface are tested; the
/// others follow from their cell. Parts that no lattice point reaches (a lobe thinner than the spacing) get a phyxel at
/// their centroid, so that no part of the body is without mass. Volumes are then scaled to sum exactly to the body's
/// volume.
///
/// Errors: spacing or count out of range, more than kMaximumPhyxels, nothing inside, cancelled.
[[nodiscard]] Result<PhyxelCloud> fill(const BodyShape &shape, const Sampling &sampling, const ParallelFor &parallelFor,
                                       const SamplingProgress &progress = {});

}  // namespace pointbased
