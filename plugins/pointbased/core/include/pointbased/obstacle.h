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
  /// Unit, direction of increasing distance: from the closest point to the query point (inside: reversed); on the
  /// surface itself its normal. It is not the normal of a face or an edge: next to an edge it is a different direction.
  /// For a sheet without an inside the distance is never negative, so the direction points to the side of the query
  /// point.
  Vec3 normal = Vec3::Zero();
  double distance = std::numeric_limits<double>::infinity();  ///< negative inside; +inf: nothing within range
};

/// A rigid object that bodies cannot enter. The library only queries it; the implementation (a tree of boxes, a
/// formula) is up to the provider.
struct Obstacle {
  std::string name;
  double friction = 0.3;     ///< Coulomb, >= 0
  double restitution = 0.0;  ///< 0 … 1, of points that arrive at it in explicit steps (ImpulseSettings)
  /// Rigid motion of a material point (placed at rest) at time t. Empty: static.
  std::function<RigidMotion(double t)> motion;
  /// Closest surface point of each point within its range, in the frame of the obstacle at rest. Called by several
  /// threads at once. Empty: no contact.
  std::function<void(std::span<const Vec3> points, std::span<const double> maxDistances, std::span<SurfacePoint> out)>
      closest;
  /// First crossing of the segment from → to, in the same frame: t in [0, 1] and the surface normal there (either
  /// side); t < 0: none. Called by several threads at once. Empty: fast points may pass through thin parts, and are
  /// pushed when they pass an edge.
  std::function<double(const Vec3 &from, const Vec3 &to, Vec3 &normal)> crossing;
  /// [contact points] of the one body that collides with it, whose rigid tissue it is: 1 for points that are part of it
  /// and do not collide with it. Empty: all points collide.
  std::vector<std::uint8_t> isPart;
  [[nodiscard]] bool actsOn(std::size_t point) const { return isPart.empty() || isPart[point] == 0; }
};

/// Walls, m.
struct WorldBox {
  bool enabled = false;
  Vec3 min = Vec3::Constant(-1.0), max = Vec3::Constant(1.0);
  double friction = 0.3;
  double restitution = 0.0;
};

}  // namespace pointbased
