// SPDX-License-Identifier: Apache-2.0
#include "instruments/clear_position.h"

namespace pointbased {
namespace {

constexpr int kMaxSteps = 60;
constexpr double kMinInPlane = 0.1;  // smallest in-plane component of the unit vector along the shortest path out
constexpr double kTolerance = 1e-3;  // radii: tolerance of "clear"

}  // namespace

std::optional<Vec3> clearPosition(const Vec3 &position, const Vec3 &normal, double radius,
                                  const std::function<SkinDistance(const Vec3 &)> &skinAt) {
  Vec3 at = position;
  for (int k = 0; k < kMaxSteps; ++k) {
    const SkinDistance skin = skinAt(at);
    const double missing = radius - skin.distance;
    if (missing <= kTolerance * radius) return at;
    const Vec3 direction = skin.outwards - skin.outwards.dot(normal) * normal;
    const double part = direction.norm();
    if (part < kMinInPlane) return std::nullopt;
    at += missing / part * direction;  // no path to that distance is shorter
  }
  return std::nullopt;
}

}  // namespace pointbased
