// SPDX-License-Identifier: Apache-2.0
// Parts of a substep of velocity Verlet, interleaved for bodies in contact with each other. Private to the core.
#pragma once

#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/coupling/rigid_state.h"

namespace pointbased::detail {

/// One substep of one body; explicitSubstep() shows the order of its parts.
class ExplicitSubstep {
 public:
  /// @param touchesBodies  contacts are solved together with those of other bodies: neither solveContacts() nor
  ///                       projectContactVelocities() is called
  ExplicitSubstep(Body &body, const Environment &environment, double time, double dt, bool touchesBodies);

  /// Evaluates the forces unless they belong to the present state.
  /// @return  whether it has evaluated them
  bool evaluateFirst();
  /// First half of the kick.
  void kickFirst();
  /// Contacts with obstacles and walls; arriving points rebound.
  void findContacts();
  void solveContacts();
  /// Drift, supports and forces.
  void drift();
  /// Second half of the kick.
  void kickLast();
  void projectContactVelocities();
  /// Mass-proportional damping of the world. The last part.
  void damp();
  /// State of a free rigid body after the parts so far; null: the body is not a free rigid one.
  [[nodiscard]] RigidState *rigid() { return rigid_ ? &*rigid_ : nullptr; }

 private:
  void kick(double h, bool drifts);
  void drift(std::size_t begin, std::size_t end);
  void evaluate(double time, double dt);
  /// A free rigid body in the form used by contact with obstacles and walls.
  struct RigidContact {
    const Interpolation &binding;
    std::span<const double> inverseMasses;
    std::span<const RigidParticles> rigid;
    std::span<Vec3> velocities;
  };
  template <class Apply>
  void applyContact(const Apply &apply);

  Body &body_;
  const Environment &env_;
  double time_, dt_;
  StepStages stages_;
  std::optional<RigidState> rigid_;
  bool isFused_;  // nothing in between: the first half kick and the drift are one loop
};

}  // namespace pointbased::detail
