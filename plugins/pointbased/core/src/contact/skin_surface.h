// SPDX-License-Identifier: Apache-2.0
// The triangles of a contact skin: joined, coarsened, divided. Private to the core.
#pragma once

#include "pointbased/interpolation.h"

namespace pointbased::detail {

/// How fine a contact skin is, against the surface that is drawn.
struct SkinResolution {
  double longestEdge = 0.0;  ///< m: longer edges are halved until they are not
  /// m: a finer surface has fewer triangles, about as many as have edges of this length; 0: all that are drawn
  double edge = 0.0;
  double deviation = 0.0;  ///< m, root mean square: so far fewer triangles may lie from those that are drawn
};

/// Points on straight lines between those of a surface, and triangles between all of them.
struct SkinSurface {
  Interpolation points;  ///< of those of the surface that are left
  std::vector<Vec3> added;
  std::vector<std::array<Index, 3>> triangles;  ///< added points are numbered behind the others
};

/// Vertices at one place that the same phyxels carry alike become one, fewer triangles stand for the drawn ones where
/// those are finer than asked for, and long edges are halved, in both triangles that share one.
/// @source  Garland and Heckbert, Surface simplification using quadric error metrics, 1997 (meshoptimizer)
[[nodiscard]] SkinSurface makeSkinSurface(Interpolation vertices, std::vector<std::array<Index, 3>> triangles,
                                          const SkinResolution &resolution);

/// Appends points to others.
void append(const Interpolation &more, Interpolation &to);

}  // namespace pointbased::detail
