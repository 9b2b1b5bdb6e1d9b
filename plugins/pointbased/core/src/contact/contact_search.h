// SPDX-License-Identifier: Apache-2.0
// What the two ways of looking for contacts share. Private to the core.
#pragma once

#include "pointbased/contact.h"

namespace pointbased::detail {

/// World to the frame of a moving obstacle at rest, m.
[[nodiscard]] inline Vec3 toRest(const RigidMotion &motion, const Vec3 &x) {
  return motion.rotation.transpose() * (x - motion.centre - motion.displacement) + motion.centre;
}

/// The points that are looked at: all, or some.
struct Looked {
  std::span<const Index> which;  ///< empty: all
  std::span<const Vec3> positions, velocities;
  std::span<const double> radii;

  [[nodiscard]] std::size_t count() const { return positions.size(); }
  [[nodiscard]] Index point(std::size_t k) const { return which.empty() ? static_cast<Index>(k) : which[k]; }
  [[nodiscard]] double radius(std::size_t k) const { return radii.empty() ? 0.0 : radii[point(k)]; }
};

/// Fills memory.active from those that are looked at; see findContacts().
/// @param count  of all points of the body
void searchContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                    std::size_t count, const Looked &looked, ContactState &memory, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
