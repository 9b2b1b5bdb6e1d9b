// SPDX-License-Identifier: Apache-2.0
// Motion of a rigid body whose state is stored in its phyxels. Private to the core.
#pragma once

#include "contact/rigid_particles.h"
#include "pointbased/types.h"

namespace pointbased::detail {

/// Pose of a rigid body: x = centre + rotation (X - centre at rest), in the frame of the phyxels.
struct RigidPose {
  Vec3 centre = Vec3::Zero();  ///< m
  Mat3 rotation = Mat3::Identity();
};

/// Velocity field of a rigid body: v = velocity + spin x (x - centre).
struct RigidVelocity {
  Vec3 velocity = Vec3::Zero();  ///< m/s, of the centre of mass
  Vec3 spin = Vec3::Zero();      ///< rad/s
};

/// Mass, centre of mass and inertia of a rigid body, from its phyxels at rest. The state remains stored in the phyxels,
/// as displacements and velocities of a rigid motion. This class converts in both directions.
///
/// Phyxels in a plane or on a line have no extent across it. The body is then regarded as one phyxel wide, a cube with
/// a standard deviation of spacing/√12. Spin about a line of phyxels does not appear in their velocities and is lost.
/// @threads  const: any
class RigidFrame {
 public:
  /// @param positions, masses  [phyxels] at rest, m; kg, above 0 in sum
  /// @param spacing  m
  RigidFrame(std::span<const Vec3> positions, std::span<const double> masses, double spacing);

  [[nodiscard]] double mass() const { return mass_; }  ///< kg
  /// Upper bound of the velocity change of a point at `arm` from the centre of mass per impulse on it, 1/kg.
  [[nodiscard]] double largestInverseMassAt(const RigidPose &pose, const Vec3 &arm) const;

  /// Pose of displacements that belong to a rigid motion.
  [[nodiscard]] RigidPose poseOf(std::span<const Vec3> positions, std::span<const Vec3> displacements,
                                 std::span<const double> masses) const;
  /// Rigid motion with the momentum and angular momentum of the velocities; exact for those of a rigid motion.
  [[nodiscard]] RigidVelocity velocityOf(const RigidPose &pose, std::span<const Vec3> positions,
                                         std::span<const Vec3> velocities, std::span<const double> masses) const;
  void place(const RigidPose &pose, std::span<const Vec3> positions, std::span<Vec3> displacements) const;
  void move(const RigidPose &pose, const RigidVelocity &motion, std::span<const Vec3> positions,
            std::span<Vec3> velocities) const;

  /// Velocity change by an impulse, N s, with a moment about the centre of mass, N m s.
  [[nodiscard]] RigidVelocity changeBy(const RigidPose &pose, const Vec3 &impulse, const Vec3 &moment) const {
    return {impulse / mass_, inverseInertia(pose) * moment};
  }
  /// Advances by dt without forces. Conserves momentum and angular momentum exactly, and energy up to rounding, at any
  /// dt. Exact if the spin keeps its axis, otherwise of second order.
  /// @source  the implicit midpoint rule in the body's frame with the exponential map; energy is conserved because a
  /// rotation about the mean spin does not change the component of the angular momentum along it
  void advance(double dt, RigidPose &pose, RigidVelocity &motion) const;

  /// Representation in the contact solver.
  [[nodiscard]] RigidParticles particles(const RigidPose &pose, Index first) const;
  /// Weights of the particles: Σ_k weight_k particle_k is the position of the phyxel. This holds for any field of a
  /// rigid motion.
  [[nodiscard]] const std::array<double, 4> &weightsOf(Index phyxel) const { return weights_[phyxel]; }
  /// Displacements of the particles, m.
  [[nodiscard]] std::array<Vec3, 4> displacementsOf(const RigidPose &pose) const;
  /// Velocities of the four particles from the rigid motion, and the inverse.
  [[nodiscard]] std::array<Vec3, 4> particleVelocities(const RigidPose &pose, const RigidVelocity &motion) const;
  [[nodiscard]] RigidVelocity velocityOf(const RigidPose &pose, std::span<const Vec3> four) const;

 private:
  [[nodiscard]] Mat3 inverseInertia(const RigidPose &pose) const;

  double mass_ = 0.0;
  Vec3 centre_ = Vec3::Zero();
  Mat3 axes_ = Mat3::Identity();                          // principal, in columns, at rest
  Vec3 extents_ = Vec3::Ones(), moments_ = Vec3::Ones();  // m, standard deviations along them; kg m²
  std::vector<std::array<double, 4>> weights_;            // [phyxels]
  Vec3 seen_ = Vec3::Zero();                              // kg m², moments of the phyxels alone; 0: none
};

}  // namespace pointbased::detail
