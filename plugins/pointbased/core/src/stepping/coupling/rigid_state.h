// SPDX-License-Identifier: Apache-2.0
// State of a free rigid body, converted from that of its phyxels and back. Private to the core.
#pragma once

#include "body/rigid_frame.h"
#include "pointbased/body.h"

namespace pointbased::detail {

/// @threads one
class RigidState {
 public:
  /// @param body  isFreeRigid()
  explicit RigidState(Body &body) : body_(body), frame_(body.rigidFrame()) {
    pose = frame_.poseOf(rest(), body.state().displacements, body.masses());
    motion = frame_.velocityOf(pose, rest(), body.state().velocities, body.masses());
  }
  [[nodiscard]] const RigidFrame &frame() const { return frame_; }
  /// Applies forces on the phyxels, N, and gravity, over h (s).
  void kick(double h, std::span<const Vec3> forces, const Vec3 &gravity) {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    const std::span<const Vec3> u = body_.state().displacements;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      force += forces[i];
      moment += (rest()[i] + u[i] - pose.centre).cross(forces[i]);
    }
    const RigidVelocity change = frame_.changeBy(pose, h * force, h * moment);
    motion.velocity += change.velocity + h * gravity;
    motion.spin += change.spin;
  }
  void advance(double dt) { frame_.advance(dt, pose, motion); }
  void store() {
    frame_.place(pose, rest(), body_.state().displacements);
    storeVelocities();
  }
  void storeVelocities() { frame_.move(pose, motion, rest(), body_.state().velocities); }

  RigidPose pose;
  RigidVelocity motion;

 private:
  [[nodiscard]] std::span<const Vec3> rest() const { return body_.rest().positions; }
  Body &body_;
  const RigidFrame &frame_;
};

}  // namespace pointbased::detail
