// SPDX-License-Identifier: Apache-2.0
// The parts of a substep of velocity Verlet, between which bodies that touch each other meet. Private to the core.
#pragma once

#include "pointbased/integrators.h"
#include "pointbased/step_composition.h"
#include "stepping/rigid_state.h"

namespace pointbased::detail {

/// One substep of one body; explicitSubstep() has the order of its parts.
class ExplicitSubstep {
 public:
  /// @param touchesBodies  contacts are solved together with those of other bodies: neither solveContacts() nor
  ///                       settleContacts() is called
  ExplicitSubstep(Body &body, const Environment &environment, double time, double dt, bool touchesBodies);

  /// Forces, where they are not those of the state. @return whether they were not
  bool evaluateFirst();
  /// The first half of the kick.
  void kickFirst();
  /// With obstacles and walls; what arrives at them bounces.
  void findContacts();
  void solveContacts();
  /// Drift, supports and forces.
  void driftOn();
  /// The second half of the kick.
  void kickLast();
  void settleContacts();
  /// What the world's damping takes. The last part.
  void damp();
  /// Of a free rigid body, where the parts so far have brought it; null: of others.
  [[nodiscard]] RigidState *rigid() { return rigid_ ? &*rigid_ : nullptr; }

 private:
  void kick(double h, bool drifts);
  void drift(std::size_t begin, std::size_t end);
  void evaluate(double time, double dt);
  /// A free rigid body as contact with obstacles and walls takes it.
  struct RigidContact {
    const Interpolation &binding;
    std::span<const double> inverseMasses;
    std::span<const RigidParticles> rigid;
    std::span<Vec3> velocities;
  };
  template <class Move>
  void moveByContact(const Move &move);

  Body &body_;
  const Environment &env_;
  double time_, dt_;
  StepStages stages_;
  std::optional<RigidState> rigid_;
  bool together_;  // with nothing in between, half a kick and the drift are one loop
};

}  // namespace pointbased::detail
