// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "pointbased/types.h"

namespace pointbased {

/// A closed surface in its own coordinates, mm. z points out of the tissue that it is placed on.
struct ImplantSurface {
  std::vector<Vec3> positions_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  double contactPlane_mm = 0.0;                         ///< z of the plane that is placed on the tissue
};

/// One dimension of a shape.
struct ImplantSize {
  std::string_view id, label;
  double value_mm, least_mm, most_mm;  ///< preset and range
};

/// A built-in shape.
struct ImplantShape {
  std::string_view name;
  std::span<const ImplantSize> sizes;
  /// @param sizes_mm  one value for each of `sizes`, within its range
  ImplantSurface (*surface)(std::span<const double> sizes_mm);
  /// Height of the underside above the contact plane at a point that the shape covers; null: it enters tissue.
  double (*underside)(double x_mm, double y_mm, std::span<const double> sizes_mm);
};

/// Plate, screw, sphere, wedge.
[[nodiscard]] std::span<const ImplantShape> implantShapes();

}  // namespace pointbased
