// SPDX-License-Identifier: Apache-2.0
#include "instruments/clear_position.h"

namespace pointbased {
namespace {

constexpr int kMaxSteps = 60;
constexpr double kFlattest = 0.1;  // smallest in-plane component of the unit vector along the shortest path out
constexpr double kNear = 1e-3;     // radii: tolerance of "clear"

}  // namespace

std::optional<Vec3> clearPosition(const Vec3 &place, const Vec3 &normal, double radius,
                                  const std::function<SkinDistance(const Vec3 &)> &skinAt) {
  Vec3 at = place;
  for (int k = 0; k < kMaxSteps; ++k) {
    const SkinDistance skin = skinAt(at);
    const double missing = radius - skin.distance;
    if (missing <= kNear * radius) return at;
    const Vec3 way = skin.outwards - skin.outwards.dot(normal) * normal;
    const double part = way.norm();
    if (part < kFlattest) return std::nullopt;
    at += missing / part * way;  // no path to that distance is shorter
  }
  return std::nullopt;
}

}  // namespace pointbased
