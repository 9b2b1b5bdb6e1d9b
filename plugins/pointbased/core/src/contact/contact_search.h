// SPDX-License-Identifier: Apache-2.0
// Shared by both searches for contacts (all points, blocks of points). Private to the core.
#pragma once

#include "pointbased/contact.h"

namespace pointbased::detail {

/// Maps a world position to the rest frame of a moving obstacle, m.
[[nodiscard]] inline Vec3 toRestFrame(const RigidMotion &motion, const Vec3 &x) {
  return motion.rotation.transpose() * (x - motion.centre - motion.displacement) + motion.centre;
}

/// Cosine: contacts whose normals agree better are the same contact. Larger: persisting contacts lose their impulses.
inline constexpr double kSamePlaneCosine = 0.9;

[[nodiscard]] inline Vec3 tangential(const Vec3 &v, const Vec3 &normal) { return v - normal.dot(v) * normal; }

/// Warm start: copies the impulses of the same contact in the previous step.
/// @return false: the normals differ, it is a new contact
inline bool warmStartFrom(const Contact &previous, Contact &contact) {
  if (previous.normal.dot(contact.normal) < kSamePlaneCosine) return false;
  contact.normalImpulse = previous.normalImpulse;
  contact.projectionImpulse = previous.projectionImpulse;
  contact.frictionImpulse = tangential(previous.frictionImpulse, contact.normal);
  contact.projectionFriction = tangential(previous.projectionFriction, contact.normal);
  contact.normalForce = previous.normalForce;
  contact.tangentialDisplacement = tangential(previous.tangentialDisplacement, contact.normal);
  return true;
}

/// Points for which contacts are searched: all of the body, or a subset.
struct QueryPoints {
  std::span<const Index> indices;  ///< empty: all
  std::span<const Vec3> positions, velocities;
  std::span<const double> radii;

  [[nodiscard]] std::size_t count() const { return positions.size(); }
  [[nodiscard]] Index point(std::size_t k) const { return indices.empty() ? static_cast<Index>(k) : indices[k]; }
  [[nodiscard]] double radius(std::size_t k) const { return radii.empty() ? 0.0 : radii[point(k)]; }
};

/// Fills memory.active from the given points; see findContacts().
/// @param count  number of all points of the body
void searchContacts(std::span<const Obstacle> obstacles, const WorldBox &box, double time, double dt, double margin,
                    std::size_t count, const QueryPoints &queryPoints, ContactState &memory,
                    const ParallelFor &parallelFor);

}  // namespace pointbased::detail
