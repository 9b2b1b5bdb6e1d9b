// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "pointbased/types.h"

namespace pointbased {

/// Closest point of an obstacle's surface.
struct SurfacePoint {
  Vec3 normal = Vec3::Zero();  ///< unit, outwards
  double distance = std::numeric_limits<double>::infinity();  ///< negative inside; +inf: nothing within range
};

/// Something that stands still and is not entered. The library asks; who answers (a tree of boxes, a formula) is not its
/// business.
struct Obstacle {
  std::string name;
  double friction = 0.3;  ///< Coulomb, >= 0
  /// Closest surface point of each point within its range. Several threads at once.
  std::function<void(std::span<const Vec3> points, std::span<const double> maxDistances, std::span<SurfacePoint> out)>
      closest;
  /// First crossing of the way from → to: t in [0, 1] and the surface's normal there; t < 0: none. Several threads at once.
  std::function<double(const Vec3 &from, const Vec3 &to, Vec3 &normal)> crossing;
};

/// Walls, m. A phyxel stays inside by its contact radius.
struct WorldBox {
  bool enabled = false;
  Vec3 min = Vec3::Constant(-1.0), max = Vec3::Constant(1.0);
  double friction = 0.3;
};

/// One side on which a phyxel may not move further.
struct ContactConstraint {
  Index phyxel = 0;
  Vec3 normal = Vec3::Zero();
  double friction = 0.0;
};

/// What contact remembers of one body between steps.
struct ContactMemory {
  /// Per obstacle and phyxel: a way that can be gone without touching; only when it is used up the obstacle is asked
  /// again. That makes free flight cheap and passing through impossible, whatever the speed.
  std::vector<std::vector<double>> clearance;
  std::vector<ContactConstraint> active;  ///< of the present step, ascending in phyxel
  double deepestEver = 0.0;               ///< m, how far a phyxel's centre has been inside an obstacle since the start

  /// Who asks an obstacle in this step, and the answers; kept so that a step allocates nothing.
  struct Questions {
    std::vector<Index> phyxels;
    std::vector<Vec3> points;
    std::vector<double> ranges;
    std::vector<SurfacePoint> answers;
  } questions;
};

/// Corrects velocities so that no phyxel enters an obstacle or leaves the box within dt: the normal part is stopped at the
/// surface (no bounce), the tangential part is braked by Coulomb friction; a phyxel that is inside already is led out
/// gently. Fills memory.active.
///
/// @param positions   [n] x, m (world)
/// @param velocities  [n] in/out, m/s
/// @param radii       [n] contact radii, m
/// @param dt          s
void resolveContacts(std::span<const Obstacle> obstacles, const WorldBox &box, std::span<const Vec3> positions,
                     std::span<Vec3> velocities, std::span<const double> radii, double spacing, double dt,
                     ContactMemory &memory, const ParallelFor &parallelFor);

/// Takes from the velocities what points into the surfaces of memory.active, with friction: after the second half of a
/// step, so that a resting body has no velocity.
void settleContacts(const ContactMemory &memory, std::span<Vec3> velocities);

}  // namespace pointbased
