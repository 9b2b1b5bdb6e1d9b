// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "pointbased/types.h"

namespace pointbased {

struct SkinDistance {
  double distance = 0.0;          ///< m, to the nearest skin, negative inside
  Vec3 outwards = Vec3::UnitZ();  ///< unit, out of the body along the shortest path
};
/// A centre at which a ball is clear of skins. This is `position` or, where the ball would intersect a skin, a nearby
/// position in a plane through it. Nothing if the skins are parallel to the plane, so that there is no short path
/// within it.
/// @param normal  unit, of the plane
/// @param radius  m, > 0
[[nodiscard]] std::optional<Vec3> clearPosition(const Vec3 &position, const Vec3 &normal, double radius,
                                                const std::function<SkinDistance(const Vec3 &)> &skinAt);

}  // namespace pointbased
