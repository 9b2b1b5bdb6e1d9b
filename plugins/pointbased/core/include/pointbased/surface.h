// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pointbased/region.h"
#include "pointbased/types.h"

namespace pointbased {

/// The border of a body as triangles, outwards by the right-hand rule.
struct Surface {
  std::vector<Vec3> positions;  ///< m
  std::vector<std::array<Index, 3>> triangles;
};

/// Points spread over a surface, each with its share of the area.
struct SurfacePoints {
  std::vector<Vec3> positions;   ///< m
  std::vector<Vec3> normals;     ///< unit, outwards
  std::vector<double> areas;     ///< m²
  std::vector<Index> triangles;  ///< the triangle each lies on

  [[nodiscard]] std::size_t count() const { return positions.size(); }
};

/// Cuts the triangles at the border of the region, divides what is inside until its edges are at most `spacing`, and
/// gives centroids and areas of the parts. Areas and first moments are exact for boxes and half-spaces and good to 1e-3
/// for spheres, whose circle in the plane of a triangle becomes a polygon of 64 sides with its area. Voxels have no plane
/// border: parts belong to those that lie behind them.
///
/// What lies within 1e-9 of the surface's size of the region counts as inside, so a face on its border is taken whole,
/// however its coordinates are rounded; strips thinner than that are not.
/// @param spacing  m; 0: no division, one point per triangle
[[nodiscard]] SurfacePoints sampleSurface(const Surface &surface, double spacing, const Region &within);

}  // namespace pointbased
