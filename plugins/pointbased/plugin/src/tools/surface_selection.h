// SPDX-License-Identifier: Apache-2.0
// Which triangles of a surface a click or a rectangle selects.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pointbased/surfels.h"
#include "tools/view_frame.h"

namespace pointbased {

using SurfaceTriangle = std::array<std::uint32_t, 3>;

/// Neighbours of triangles across their edges, by the indices of corners: coincident corners are welded before.
class TriangleNeighbours {
 public:
  explicit TriangleNeighbours(std::span<const SurfaceTriangle> triangles);
  /// Those that share an edge with it; more than three where edges have more than two triangles.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t triangle) const {
    return std::span(all_).subspan(first_[triangle], first_[triangle + 1] - first_[triangle]);
  }

 private:
  std::vector<std::uint32_t> first_, all_;
};

/// Where a picked face ends.
enum class FaceBorder : std::uint32_t {
  crease,  ///< at edges whose two triangles differ in direction by more than the angle
  tilt,    ///< where the normal deviates from that of the picked triangle by more than the angle
};

/// The connected part of a surface around a triangle, ascending.
/// @param positions  m, of the corners; the reference, so that a deformation does not change the result
/// @param angle_deg  0 … 180
[[nodiscard]] std::vector<std::uint32_t> faceAround(std::span<const Vec3> positions,
                                                    std::span<const SurfaceTriangle> triangles,
                                                    const TriangleNeighbours &neighbours, std::uint32_t triangle,
                                                    FaceBorder border, double angle_deg);

/// Triangles whose centre is in a rectangle of the view and before the eye, ascending.
/// @param facesViewer  only those whose outer side faces the eye
[[nodiscard]] std::vector<std::uint32_t> trianglesInRect(std::span<const Vec3f> positions,
                                                         std::span<const SurfaceTriangle> triangles,
                                                         const ViewFrame &frame, const PixelRect &rect,
                                                         bool facesViewer);

/// Triangles of which a part is in a rectangle of a slice and between two depths, ascending.
/// @param low, high  m, along the viewing direction from the plane of the slice
[[nodiscard]] std::vector<std::uint32_t> trianglesInSlab(std::span<const Vec3f> positions,
                                                         std::span<const SurfaceTriangle> triangles,
                                                         const ViewFrame &frame, const PixelRect &rect, double low,
                                                         double high);

/// m.
[[nodiscard]] Vec3 centreOf(std::span<const Vec3f> positions, const SurfaceTriangle &triangle);
/// m².
[[nodiscard]] double areaOf(std::span<const Vec3f> positions, const SurfaceTriangle &triangle);

}  // namespace pointbased
