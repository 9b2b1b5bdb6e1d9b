// SPDX-License-Identifier: Apache-2.0
// The motion of a rigid body whose state is that of its phyxels. Private to the core.
#pragma once

#include "contact/rigid_particles.h"
#include "pointbased/types.h"

namespace pointbased::detail {

/// Where a rigid body is: x = centre + rotation (X - centre at rest), in the frame of the phyxels.
struct RigidPose {
  Vec3 centre = Vec3::Zero();  ///< m
  Mat3 rotation = Mat3::Identity();
};

/// How a rigid body moves: v = velocity + spin x (x - centre).
struct RigidVelocity {
  Vec3 velocity = Vec3::Zero();  ///< m/s, of the centre of mass
  Vec3 spin = Vec3::Zero();      ///< rad/s
};

/// Mass, centre of mass and inertia of a rigid body, from the masses of its phyxels at rest. Its state stays that of
/// the phyxels, whose displacements and velocities are those of a rigid motion: both ways are here.
///
/// Phyxels in a plane or on a line have no extent across it; a body is taken to be as wide there as one phyxel, whose
/// cube has a standard deviation of spacing/√12. The spin about a line of phyxels does not show in their velocities and
/// is forgotten.
/// @threads const: any
class RigidFrame {
 public:
  /// @param positions, masses  [phyxels] at rest, m; kg, above 0 in sum
  /// @param spacing  m
  RigidFrame(std::span<const Vec3> positions, std::span<const double> masses, double spacing);

  [[nodiscard]] double mass() const { return mass_; }  ///< kg
  /// By how much an impulse on a point, at `arm` from the centre of mass, changes its velocity at most, 1/kg.
  [[nodiscard]] double largestInverseMassAt(const RigidPose &pose, const Vec3 &arm) const;

  /// The pose that displacements of a rigid motion tell.
  [[nodiscard]] RigidPose poseOf(std::span<const Vec3> positions, std::span<const Vec3> displacements,
                                 std::span<const double> masses) const;
  /// The rigid motion with the momentum and angular momentum of these velocities: of a rigid motion itself.
  [[nodiscard]] RigidVelocity velocityOf(const RigidPose &pose, std::span<const Vec3> positions,
                                         std::span<const Vec3> velocities, std::span<const double> masses) const;
  void place(const RigidPose &pose, std::span<const Vec3> positions, std::span<Vec3> displacements) const;
  void move(const RigidPose &pose, const RigidVelocity &motion, std::span<const Vec3> positions,
            std::span<Vec3> velocities) const;

  /// What an impulse, N s, with a moment about the centre of mass, N m s, changes.
  [[nodiscard]] RigidVelocity changeBy(const RigidPose &pose, const Vec3 &impulse, const Vec3 &moment) const {
    return {impulse / mass_, inverseInertia(pose) * moment};
  }
  /// On by dt without forces: keeps momentum and angular momentum exactly, and energy to rounding, at any dt. Exact
  /// where the spin keeps its axis, else of second order.
  /// @source  the implicit midpoint rule in the body's frame with the exponential map; energy stays because a rotation
  ///          about the mean spin does not change the component of the angular momentum along it
  void advance(double dt, RigidPose &pose, RigidVelocity &motion) const;

  /// As contact takes it.
  [[nodiscard]] RigidParticles particles(const RigidPose &pose, Index first) const;
  /// Σ_k weight_k particle_k is where the phyxel is; of a field of a rigid motion as well.
  [[nodiscard]] const std::array<double, 4> &weightsOf(Index phyxel) const { return weights_[phyxel]; }
  /// m, by which the particles have gone.
  [[nodiscard]] std::array<Vec3, 4> displacementsOf(const RigidPose &pose) const;
  /// Of the four particles, and back.
  [[nodiscard]] std::array<Vec3, 4> particleVelocities(const RigidPose &pose, const RigidVelocity &motion) const;
  [[nodiscard]] RigidVelocity velocityOf(const RigidPose &pose, std::span<const Vec3> four) const;

 private:
  [[nodiscard]] Mat3 inverseInertia(const RigidPose &pose) const;

  double mass_ = 0.0;
  Vec3 centre_ = Vec3::Zero();
  Mat3 axes_ = Mat3::Identity();                          // principal, in columns, at rest
  Vec3 extents_ = Vec3::Ones(), moments_ = Vec3::Ones();  // m, standard deviations along them; kg m²
  std::vector<std::array<double, 4>> weights_;            // [phyxels]
  Vec3 seen_ = Vec3::Zero();                              // kg m², moments of the phyxels; 0: none
};

}  // namespace pointbased::detail
