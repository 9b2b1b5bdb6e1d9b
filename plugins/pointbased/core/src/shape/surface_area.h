// SPDX-License-Identifier: Apache-2.0
// Private to the core.
#pragma once

#include "pointbased/surface.h"

namespace pointbased::detail {

/// Area of all triangles, m².
[[nodiscard]] inline double areaOf(const Surface &surface) {
  double area = 0.0;
  for (const auto &t : surface.triangles) {
    const Vec3 &a = surface.positions[t[0]];
    area += 0.5 * (surface.positions[t[1]] - a).cross(surface.positions[t[2]] - a).norm();
  }
  return area;
}

}  // namespace pointbased::detail
