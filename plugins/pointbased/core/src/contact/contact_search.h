// SPDX-License-Identifier: Apache-2.0
// Shared by both searches for contacts (all points, blocks of points). Private to the core.
#pragma once

#include "pointbased/contact.h"

namespace pointbased::detail {

/// Maps a world position to the rest frame of a moving obstacle, m.
[[nodiscard]] inline Vec3 toRest(const RigidMotion &motion, const Vec3 &x) {
  return motion.rotation.transpose() * (x - motion.centre - motion.displacement) + motion.centre;
}

/// Cosine: contact planes whose normals agree better are the same side. Larger: persisting contacts lose their
/// impulses.
inline constexpr double kSameSide = 0.9;

[[nodiscard]] inline Vec3 tangential(const Vec3 &v, const Vec3 &normal) { return v - normal.dot(v) * normal; }

/// Carries the impulses of a persisting contact over from the previous step.
/// @return false: it is another side, a new contact
inline bool remember(const Contact &was, Contact &contact) {
  if (was.normal.dot(contact.normal) < kSameSide) return false;
  contact.normalImpulse = was.normalImpulse;
  contact.settleImpulse = was.settleImpulse;
  contact.frictionImpulse = tangential(was.frictionImpulse, contact.normal);
  contact.settleFriction = tangential(was.settleFriction, contact.normal);
  contact.normalForce = was.normalForce;
  contact.tangentialDisplacement = tangential(was.tangentialDisplacement, contact.normal);
  return true;
}

/// Points to be tested: all of the body, or a subset.
struct Looked {
  std::span<const Index> which;  ///< empty: all
  std::span<const Vec3> positions, velocities;
  std::span<const double> radii;

  [[nodiscard]] std::size_t count() const { return positions.size(); }
  [[nodiscard]] Index point(std::size_t k) const { return which.empty() ? static_cast<Index>(k) : which[k]; }
  [[nodiscard]] double radius(std::size_t k) const { return radii.empty() ? 0.0 : radii[point(k)]; }
};

/// Fills memory.active from the given points; see findContacts().
/// @param count  number of all points of the body
void searchContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                    std::size_t count, const Looked &looked, ContactState &memory, const ParallelFor &parallelFor);

}  // namespace pointbased::detail
