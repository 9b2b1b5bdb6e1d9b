// SPDX-License-Identifier: Apache-2.0
// Private to the core.
#pragma once

#include "pointbased/surface.h"

namespace pointbased::detail {

/// Volume of a body with its first and second moments about one point.
struct VolumeMoments {
  double volume = 0.0;         ///< m³
  Vec3 first = Vec3::Zero();   ///< ∫x dV, m⁴
  Mat3 second = Mat3::Zero();  ///< ∫x xᵀ dV, m⁵

  /// m, edges of the box with the same central second moments, in ascending order; not numbers without volume.
  [[nodiscard]] Vec3 boxEdges() const;
};

/// Moments of the connected part of a closed surface that encloses the largest volume, about its first vertex. Vertices
/// with equal positions are connected. The surface has at least one triangle.
[[nodiscard]] VolumeMoments momentsOfLargestPart(const Surface &surface);

}  // namespace pointbased::detail
