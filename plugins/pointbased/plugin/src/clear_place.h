// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "pointbased/types.h"

namespace pointbased {

struct SkinDistance {
  double distance = 0.0;          ///< m, of the nearest skin, negative inside
  Vec3 outwards = Vec3::UnitZ();  ///< unit, out of the body, the shortest way
};
/// Where a ball stands clear of skins: at a place or, where it would lie in a skin, beside it in a plane through the
/// place, by a short way. Nothing: the skins lie along the plane, so no way within it leads out soon.
/// @param normal  unit, of the plane
/// @param radius  m, > 0
[[nodiscard]] std::optional<Vec3> clearPlace(const Vec3 &place, const Vec3 &normal, double radius,
                                             const std::function<SkinDistance(const Vec3 &)> &skinAt);

}  // namespace pointbased
