// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "pointbased/region.h"
#include "pointbased/types.h"

namespace pointbased {

/// The border of a body as triangles, oriented outwards by the right-hand rule.
struct Surface {
  std::vector<Vec3> positions;  ///< m
  std::vector<std::array<Index, 3>> triangles;
};

/// Points distributed over a surface, each with its share of the area.
struct SurfacePoints {
  std::vector<Vec3> positions;   ///< m
  std::vector<Vec3> normals;     ///< unit, outwards
  std::vector<double> areas;     ///< m²
  std::vector<Index> triangles;  ///< triangle that contains each point

  [[nodiscard]] std::size_t count() const { return positions.size(); }
};

/// Clips the triangles at the border of the region, subdivides the part inside until its edges are at most `spacing`,
/// and returns centroids and areas. Areas and first moments are exact for boxes and half-spaces and accurate to 1e-3
/// for spheres, whose circle in the plane of a triangle is approximated by a polygon of 64 sides with the same area.
/// Voxels have no plane border: parts belong to the voxels behind them.
///
/// Everything within 1e-9 of the surface's size of the region counts as inside. A face on the border is therefore
/// included completely, whatever the rounding of its coordinates; thinner strips are not.
/// @param spacing  m; 0: no division, one point per triangle
[[nodiscard]] SurfacePoints sampleSurface(const Surface &surface, double spacing, const Region &within);

}  // namespace pointbased
