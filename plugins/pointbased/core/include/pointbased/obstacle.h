// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "pointbased/supports.h"
#include "pointbased/types.h"

namespace pointbased {

/// Closest point of an obstacle's surface.
struct SurfacePoint {
  /// Unit, the way in which the distance grows: from the closest point to the one that asked (inside: back); on the
  /// surface itself its normal. Not the normal of a face or an edge: beside an edge that is another direction. For a
  /// sheet without inside the distance is never negative, so it is on the side of the one that asked.
  Vec3 normal = Vec3::Zero();
  double distance = std::numeric_limits<double>::infinity();  ///< negative inside; +inf: nothing within range
};

/// Something that stands still and is not entered. The library asks; who answers (a tree of boxes, a formula) is not
/// its business.
struct Obstacle {
  std::string name;
  double friction = 0.3;     ///< Coulomb, >= 0
  double restitution = 0.0;  ///< 0 … 1, of points that arrive at it in explicit steps (ImpulseSettings)
  /// Empty: stands still. Else its rigid motion: where a material point of it (placed at rest) is at time t.
  std::function<RigidMotion(double t)> motion;
  /// Closest surface point of each point within its range, in the frame of the obstacle at rest. Several threads at
  /// once. Empty: it is not felt.
  std::function<void(std::span<const Vec3> points, std::span<const double> maxDistances, std::span<SurfacePoint> out)>
      closest;
  /// First crossing of the way from → to, likewise: t in [0, 1] and the normal of the surface there (either side); t
  /// < 0: none. Several threads at once. Empty: fast points may pass thin parts, and pass by edges with a push.
  std::function<double(const Vec3 &from, const Vec3 &to, Vec3 &normal)> crossing;
  /// [points of contact] of the one body that feels it, whose rigid tissue it is: 1, part of it, and it is not felt.
  /// Empty: all feel it.
  std::vector<std::uint8_t> isPart;
  [[nodiscard]] bool isFeltBy(std::size_t point) const { return isPart.empty() || isPart[point] == 0; }
};

/// Walls, m.
struct WorldBox {
  bool enabled = false;
  Vec3 min = Vec3::Constant(-1.0), max = Vec3::Constant(1.0);
  double friction = 0.3;
  double restitution = 0.0;
};

}  // namespace pointbased
