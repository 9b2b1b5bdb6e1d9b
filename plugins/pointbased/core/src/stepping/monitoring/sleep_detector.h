// SPDX-License-Identifier: Apache-2.0
// Detects bodies at rest. Private to the core.
#pragma once

#include "pointbased/body.h"

namespace pointbased::detail {

/// A body is at rest if for kRestDuration no phyxel has moved by more than the tolerance. Displacements are checked,
/// not velocities: velocities of a resting body are residuals of its contact solution, and cause no net motion. Creep
/// and oscillations within the tolerance are below the accuracy of the state. By default the tolerance is 1e-4 of the
/// spacing; discretisation errors are hundreds of times larger.
class SleepDetector {
 public:
  static constexpr double kRestDuration = 0.5;   // s
  static constexpr double kTolerance = 1e-4;     // of the spacing
  static constexpr double kPollInterval = 1e-3;  // s

  /// Call after a step of dt during which nothing external has driven the body.
  /// @return  true: it is at rest
  [[nodiscard]] bool update(const Body &body, double tolerance, double dt);
  void clear() { reference_.clear(); }

  /// Visits every number, for saved states.
  template <class Archive>
  void walk(Archive &archive) {
    archive(reference_);
    archive(restTime_);
    archive(timeSinceCheck_);
  }

 private:
  std::vector<Vec3> reference_;  // [phyxels] m, displacements at the beginning of the present rest
  double restTime_ = 0.0;        // s, duration of the rest
  double timeSinceCheck_ = 0.0;  // s since the last check
};

/// Whether an obstacle moves between `time` and `time` + dt; empty: it is static.
[[nodiscard]] bool isMoving(const std::function<RigidMotion(double t)> &motion, double time, double dt);

/// Whether the body is driven, or will be before `time` + dt: by a grab, external forces, a support or load with an
/// unfinished ramp, a moving obstacle, or relaxing material.
[[nodiscard]] bool isDriven(const Body &body, std::span<const Obstacle> obstacles, double time, double dt);

}  // namespace pointbased::detail
