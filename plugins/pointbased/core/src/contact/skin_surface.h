// SPDX-License-Identifier: Apache-2.0
// Welds, coarsens and subdivides the triangles of a contact skin. Private to the core.
#pragma once

#include "pointbased/interpolation.h"

namespace pointbased::detail {

/// Resolution of a contact skin relative to the displayed surface.
struct SkinResolution {
  double longestEdge = 0.0;  ///< m: longer edges are halved until none is longer
  /// Target edge length of coarsening, m. A finer surface gets about as many triangles as edges of this length have; 0:
  /// all displayed triangles are used.
  double edge = 0.0;
  double deviation = 0.0;  ///< root-mean-square distance allowed between the coarsened and the displayed surface, m
};

/// Remaining points of a surface, points added on its edges, and the triangles between all of them.
struct SkinSurface {
  Interpolation points;  ///< remaining points of the displayed surface
  std::vector<Vec3> added;
  std::vector<std::array<Index, 3>> triangles;  ///< added points are numbered after the others
};

/// Welds vertices at the same position that have the same phyxels and weights, replaces the displayed triangles by
/// fewer ones where they are finer than requested, and halves long edges in both adjacent triangles.
/// @source  Garland and Heckbert, Surface simplification using quadric error metrics, 1997 (meshoptimizer)
[[nodiscard]] SkinSurface makeSkinSurface(Interpolation vertices, std::vector<std::array<Index, 3>> triangles,
                                          const SkinResolution &resolution);

void append(const Interpolation &more, Interpolation &to);

}  // namespace pointbased::detail
