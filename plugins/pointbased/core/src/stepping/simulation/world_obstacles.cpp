// SPDX-License-Identifier: Apache-2.0
// Obstacles, and their guidance during the simulation.
#include <Eigen/Geometry>
#include <algorithm>

#include "base/expects.h"
#include "stepping/simulation/simulation_state.h"

namespace pointbased {
namespace {

using Motion = detail::ObstacleMotion;

// The same motion, about another centre.
RigidMotion about(const Vec3 &centre, const RigidMotion &motion) {
  return {motion.rotation, centre, motion.displacementOf(centre)};
}

}  // namespace

Motion detail::Guidance::motion() const {
  const Eigen::AngleAxisd turn(to.rotation * from.rotation.transpose());
  return [course = *this, turn](double t) {
    if (!(t < course.begin + course.duration)) return course.to;
    const double s = std::max(0.0, (t - course.begin) / course.duration);
    RigidMotion now = course.from;
    now.rotation = Eigen::AngleAxisd(s * turn.angle(), turn.axis()).toRotationMatrix() * course.from.rotation;
    now.displacement += s * (course.to.displacement - course.from.displacement);
    return now;
  };
}

std::size_t World::addObstacle(Obstacle obstacle) {
  ++state_.historyEpoch;
  state_.obstacles.all.push_back(std::move(obstacle));
  state_.obstacles.ids.push_back(state_.nextId);
  state_.updateSurroundings();
  for (auto &[id, stepper] : state_.bodies) {
    stepper->body().contact = ContactState();
    stepper->wake();
  }
  return state_.nextId++;
}

std::size_t World::addInstrument(Obstacle obstacle) {
  state_.obstacles.all.push_back(std::move(obstacle));
  state_.obstacles.ids.push_back(state_.nextId);
  state_.obstacles.instruments.insert(state_.nextId);
  state_.updateSurroundings();
  for (auto &[id, stepper] : state_.bodies) {
    stepper->body().contact.sums = ContactSums();
    stepper->body().contact.blocks = ContactState::Blocks();
    stepper->wake();
  }
  return state_.nextId++;
}

bool World::removeObstacle(std::size_t id) { return state_.removeObstacle(id); }
std::span<const Obstacle> World::obstacles() const { return state_.obstacles.all; }
const Obstacle *World::obstacle(std::size_t id) const { return state_.obstacle(id); }
bool World::isInstrument(std::size_t id) const { return state_.obstacles.instruments.contains(id); }
bool World::isGuided(std::size_t id) const { return state_.obstacles.ownMotions.contains(id); }

RigidMotion World::obstacleMotion(std::size_t id) const {
  const Obstacle *found = state_.obstacle(id);
  return found && found->motion ? found->motion(state_.rampTime()) : RigidMotion{};
}

Motion World::motionAtReset(std::size_t id) const {
  if (const auto own = state_.obstacles.ownMotions.find(id); own != state_.obstacles.ownMotions.end())
    return own->second;
  const Obstacle *found = state_.obstacle(id);
  return found ? found->motion : Motion();
}

void World::guideObstacle(std::size_t id, const RigidMotion &target, double duration) {
  POINTBASED_EXPECTS(
      target.rotation.allFinite() && target.centre.allFinite() && target.displacement.allFinite() && duration >= 0.0,
      "a finite place, and a time that is not negative");
  const Obstacle *found = state_.obstacle(id);
  if (!found) return;
  const bool standsStill =
      state_.obstacles.instruments.contains(id) || state_.placed.contains(id) || !motionAtReset(id);
  const bool begins = state_.progress.steps == 0 && standsStill;
  const detail::Guidance guidance{about(target.centre, obstacleMotion(id)), target, state_.rampTime(),
                                  begins ? 0.0 : duration};
  if (!begins) return state_.guide(id, guidance);
  state_.placed.insert(id);
  state_.obstacles.ownMotions.erase(id);
  state_.obstacles.guidances.erase(id);
  state_.setMotion(id, guidance.motion());
}

}  // namespace pointbased
