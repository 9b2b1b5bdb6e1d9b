// SPDX-License-Identifier: Apache-2.0
// Rigid bodies among what contact moves. Private to the core.
#pragma once

#include <array>

#include "pointbased/contact.h"

namespace pointbased::detail {

/// A rigid body as contact sees it: four particles of a quarter of its mass each, with its centre of mass and its
/// inertia. Any point of it is a weighted sum of the four, so contacts hold them with rows of weights as they hold
/// phyxels; only an impulse moves the four as the rigid body, not one by one.
struct RigidParticles {
  Index first = 0;                         ///< number of the first of the four among what is moved
  double mass = 0.0;                       ///< kg, of all
  std::array<Vec3, 4> arms{};              ///< m, from the centre of mass, in the world
  Mat3 inverseInertia = Mat3::Identity();  ///< 1/(kg m²), likewise
  [[nodiscard]] double inverseMass() const { return 4.0 / mass; }  ///< 1/kg, of each of the four

  /// To the rigid motion with the same momentum and angular momentum.
  /// @param four  m/s
  void project(std::span<Vec3> four) const {
    const Vec3 mean = 0.25 * (four[0] + four[1] + four[2] + four[3]);
    Vec3 spin = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) spin += arms[k].cross(four[k] - mean);
    spin = inverseInertia * (0.25 * mass * spin);
    for (std::size_t k = 0; k < 4; ++k) four[k] = mean + spin.cross(arms[k]);
  }
};

/// As those of contact.h, where some of what moves are rigid bodies.
/// @param rigid  in the order of their particles
Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses,
                          std::span<const RigidParticles> rigid, double dt, const ImpulseSettings &settings,
                          ContactState &memory, std::span<Vec3> velocities);
void settleContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses,
                             std::span<const RigidParticles> rigid, ContactState &memory, std::span<Vec3> velocities);
/// As bounceArrivals() of contact_bounce.h, likewise.
Vec3 bounceArrivals(const Interpolation &binding, std::span<const double> inverseMasses,
                    std::span<const RigidParticles> rigid, double quietSpeed, ContactState &memory,
                    std::span<Vec3> velocities);

}  // namespace pointbased::detail
