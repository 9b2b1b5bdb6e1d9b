// SPDX-License-Identifier: Apache-2.0
// Private to registration: checks of what was measured.
#pragma once

#include <string>
#include <vector>

#include "robust_fit.h"

namespace c3de::registration {

struct CheckedInput {
  MovingPoints points;  ///< each position once
  std::vector<std::string> warnings;
  double extent_mm = 0.0;  ///< twice the median distance from the middle, which outliers do not enlarge
};

/// Errors and warnings of registerRigid() about its input.
[[nodiscard]] Expected<CheckedInput> checkInput(const TargetSurface &target, const MeasuredSurface &measured,
                                                const RegistrationOptions &options);

/// Twice the median distance of the points from their middle, which is the median of each coordinate.
[[nodiscard]] double medianExtent(const std::vector<Vec3> &points);

/// Extents that show another unit. A part of a surface has a twentieth of its extent, not a hundredth.
/// @param points_mm  medianExtent() of the measured points
[[nodiscard]] Expected<void> checkExtent(double points_mm, const TargetSurface &target);

/// The first point whose coordinates are not finite. @param what  "measured point"
[[nodiscard]] Expected<void> checkFinite(const std::vector<Vec3> &points, const char *what);

}  // namespace c3de::registration
