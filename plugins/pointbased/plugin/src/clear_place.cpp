// SPDX-License-Identifier: Apache-2.0
#include "clear_place.h"

namespace pointbased {
namespace {

constexpr int kMostSteps = 60;
constexpr double kFlattest = 0.1;  // part of the shortest way out that lies in the plane
constexpr double kNear = 1e-3;     // radii: that near is clear

}  // namespace

std::optional<Vec3> clearPlace(const Vec3 &place, const Vec3 &normal, double radius,
                               const std::function<SkinDistance(const Vec3 &)> &skinAt) {
  Vec3 at = place;
  for (int k = 0; k < kMostSteps; ++k) {
    const SkinDistance skin = skinAt(at);
    const double missing = radius - skin.distance;
    if (missing <= kNear * radius) return at;
    const Vec3 way = skin.outwards - skin.outwards.dot(normal) * normal;
    const double part = way.norm();
    if (part < kFlattest) return std::nullopt;
    at += missing / part * way;  // no way to there is shorter
  }
  return std::nullopt;
}

}  // namespace pointbased
