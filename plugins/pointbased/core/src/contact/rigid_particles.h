// SPDX-License-Identifier: Apache-2.0
// Rigid bodies in the contact solver. Private to the core.
#pragma once

#include <array>

#include "pointbased/contact.h"

namespace pointbased::detail {

/// A rigid body as four particles with a quarter of its mass each, and with its centre of mass and inertia. Any point
/// of it is a weighted sum of the four, so contacts refer to them by rows of weights as for phyxels. An impulse moves
/// the four as a rigid body, not individually.
struct RigidParticles {
  Index first = 0;                         ///< number of the first of the four among all particles
  double mass = 0.0;                       ///< kg, of the whole body
  std::array<Vec3, 4> arms{};              ///< m, relative to the centre of mass, world axes
  Mat3 inverseInertia = Mat3::Identity();  ///< 1/(kg m²), world axes
  [[nodiscard]] double inverseMass() const { return 4.0 / mass; }  ///< 1/kg, of each of the four

  /// Projects velocities onto the rigid motion with the same momentum and angular momentum.
  /// @param four  m/s
  void project(std::span<Vec3> four) const {
    const Vec3 mean = 0.25 * (four[0] + four[1] + four[2] + four[3]);
    Vec3 spin = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) spin += arms[k].cross(four[k] - mean);
    spin = inverseInertia * (0.25 * mass * spin);
    for (std::size_t k = 0; k < 4; ++k) four[k] = mean + spin.cross(arms[k]);
  }
};

/// Same as in contact.h, for systems that contain rigid bodies.
/// @param rigid  in the order of their particles
Vec3 solveContactImpulses(const Interpolation &binding, std::span<const double> inverseMasses,
                          std::span<const RigidParticles> rigid, double dt, const ImpulseSettings &settings,
                          ContactState &memory, std::span<Vec3> velocities);
void projectContactVelocities(const Interpolation &binding, std::span<const double> inverseMasses,
                              std::span<const RigidParticles> rigid, ContactState &memory, std::span<Vec3> velocities);
/// Same as applyRestitution() in contact_bounce.h, with rigid bodies.
Vec3 applyRestitution(const Interpolation &binding, std::span<const double> inverseMasses,
                      std::span<const RigidParticles> rigid, double restitutionThreshold, ContactState &memory,
                      std::span<Vec3> velocities);

}  // namespace pointbased::detail
