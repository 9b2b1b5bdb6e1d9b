// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/sleep_detector.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
bool SleepDetector::look(const Body &body, double tolerance, double dt) {
  unseen_ += dt;
  if (unseen_ < kPollInterval) return false;
  const double passed = unseen_;
  unseen_ = 0.0;
  const State &state = body.state();
  if (state.displacements.empty()) return false;
  const double farthest = tolerance * tolerance;
  bool still = from_.size() == state.displacements.size();
  // NaN counts as motion.
  for (std::size_t i = 0; still && i < from_.size(); ++i)
    still = (state.displacements[i] - from_[i]).squaredNorm() <= farthest;
  if (still) {
    since_ += passed;
    return since_ >= kStillFor;
  }
  since_ = 0.0;
  from_ = state.displacements;
  return false;
}

bool goesOn(const std::function<RigidMotion(double t)> &motion, double time, double dt) {
  if (!motion) return false;
  const RigidMotion a = motion(time), b = motion(time + dt);
  return a.rotation != b.rotation || a.displacement != b.displacement || a.centre != b.centre;
}

bool isDriven(const Body &body, std::span<const Obstacle> obstacles, double time, double dt) {
  if (!body.grabs.empty() || !body.externalForces().empty() || (!body.rigid() && body.constitution().relaxing()))
    return true;
  for (const Obstacle &obstacle : obstacles)
    if (goesOn(obstacle.motion, time, dt)) return true;
  const BoundaryConditions &conditions = body.rest().conditions;
  const auto isRamped = [time](const auto &one) { return one.ramp > 0.0 && time < one.ramp; };
  return std::any_of(conditions.fixes.begin(), conditions.fixes.end(), isRamped) ||
         std::any_of(conditions.loads.begin(), conditions.loads.end(), isRamped);
}

}  // namespace pointbased::detail
