// SPDX-License-Identifier: Apache-2.0
#include "stepping/monitoring/sleep_detector.h"

#include <algorithm>
#include <cmath>

namespace pointbased::detail {
bool SleepDetector::update(const Body &body, double tolerance, double dt) {
  timeSinceCheck_ += dt;
  if (timeSinceCheck_ < kPollInterval) return false;
  const double elapsed = timeSinceCheck_;
  timeSinceCheck_ = 0.0;
  const State &state = body.state();
  if (state.displacements.empty()) return false;
  const double maxSquared = tolerance * tolerance;
  bool isAtRest = reference_.size() == state.displacements.size();
  // NaN counts as motion.
  for (std::size_t i = 0; isAtRest && i < reference_.size(); ++i)
    isAtRest = (state.displacements[i] - reference_[i]).squaredNorm() <= maxSquared;
  if (isAtRest) {
    restTime_ += elapsed;
    return restTime_ >= kRestDuration;
  }
  restTime_ = 0.0;
  reference_ = state.displacements;
  return false;
}

bool isMoving(const std::function<RigidMotion(double t)> &motion, double time, double dt) {
  if (!motion) return false;
  const RigidMotion a = motion(time), b = motion(time + dt);
  return a.rotation != b.rotation || a.displacement != b.displacement || a.centre != b.centre;
}

bool isDriven(const Body &body, std::span<const Obstacle> obstacles, double time, double dt) {
  if (!body.grabs.empty() || !body.externalForces().empty() || (!body.rigid() && body.constitution().relaxing()))
    return true;
  for (const Obstacle &obstacle : obstacles)
    if (isMoving(obstacle.motion, time, dt)) return true;
  const BoundaryConditions &conditions = body.rest().conditions;
  const auto isRamped = [time](const auto &one) { return one.ramp > 0.0 && time < one.ramp; };
  const auto isLiveRamped = [time](const LiveSupport &one) { return time < one.start + one.ramp; };
  const std::span<const LiveSupport> live = body.liveSupports();
  return std::any_of(live.begin(), live.end(), isLiveRamped) ||
         std::any_of(conditions.fixes.begin(), conditions.fixes.end(), isRamped) ||
         std::any_of(conditions.loads.begin(), conditions.loads.end(), isRamped);
}

}  // namespace pointbased::detail
