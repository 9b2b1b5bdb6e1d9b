// SPDX-License-Identifier: Apache-2.0
// When a body has come to rest. Private to the core.
#pragma once

#include "pointbased/body.h"

namespace pointbased::detail {

/// A body rests when for kStillFor no phyxel has left a place by more than the tolerance: no force has moved it. Looked
/// at are ways, not velocities: those of a body that rests on something are what an unfinished solution of its contacts
/// leaves, and take it nowhere. What still creeps or swings within the tolerance is beyond what the state says: by
/// default that is 1e-4 of the spacing, errors of the discretisation are hundreds of times as large.
class SleepDetector {
 public:
  static constexpr double kStillFor = 0.5;    // s
  static constexpr double kTolerance = 1e-4;  // of the spacing
  static constexpr double kLookEvery = 1e-3;  // s

  /// After a step of dt that nothing outside has driven. @return true: it rests
  [[nodiscard]] bool look(const Body &body, double tolerance, double dt);
  void forget() { from_.clear(); }

  /// Every number of it, for files.
  template <class Archive>
  void walk(Archive &archive) {
    archive(from_);
    archive(since_);
    archive(unseen_);
  }

 private:
  std::vector<Vec3> from_;  // [phyxels] m, displacements when the present stillness began
  double since_ = 0.0;      // s of it
  double unseen_ = 0.0;     // s since the last look
};

/// Whether the motion of an obstacle leads anywhere from `time` to `time` + dt; empty: it stands still.
[[nodiscard]] bool goesOn(const std::function<RigidMotion(double t)> &motion, double time, double dt);

/// Somebody or something moves the body, or will before `time` + dt: a hand, a support or load whose ramp has not
/// ended, an obstacle on its way that touches or can reach it, material that relaxes.
[[nodiscard]] bool isDriven(const Body &body, std::span<const Obstacle> obstacles, double time, double dt);

}  // namespace pointbased::detail
