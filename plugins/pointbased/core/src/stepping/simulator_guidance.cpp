// SPDX-License-Identifier: Apache-2.0
// Obstacles that are guided during the simulation.
#include <Eigen/Geometry>
#include <algorithm>

#include "base/expects.h"
#include "pointbased/simulator.h"
#include "stepping/attachment_layer.h"
#include "stepping/simulator_checkpoint.h"

namespace pointbased {
namespace {

using Motion = std::function<RigidMotion(double t)>;

// The same motion, about another centre.
RigidMotion about(const Vec3 &centre, const RigidMotion &motion) {
  return {motion.rotation, centre, motion.displacementOf(centre)};
}

// Motion at constant rates from one pose to another, by the smaller rotation.
Motion between(const RigidMotion &from, const RigidMotion &to, double begin, double duration) {
  const RigidMotion start = about(to.centre, from);
  const Eigen::AngleAxisd turn(to.rotation * start.rotation.transpose());
  return [start, to, turn, begin, duration](double t) {
    if (!(t < begin + duration)) return to;
    const double s = std::max(0.0, (t - begin) / duration);
    RigidMotion now = start;
    now.rotation = Eigen::AngleAxisd(s * turn.angle(), turn.axis()).toRotationMatrix() * start.rotation;
    now.displacement += s * (to.displacement - start.displacement);
    return now;
  };
}

}  // namespace

std::size_t Simulator::addInstrument(Obstacle obstacle) {
  obstacles_.push_back(std::move(obstacle));
  obstacleIds_.push_back(nextId_);
  instruments_.insert(nextId_);
  updateSurroundings();
  for (auto &[id, stepper] : bodies_) {
    stepper->body().contact.sums = ContactSums();
    stepper->body().contact.blocks = ContactState::Blocks();
    stepper->wake();
  }
  return nextId_++;
}

void Simulator::setMotion(std::size_t id, Motion motion) {
  const auto found = std::find(obstacleIds_.begin(), obstacleIds_.end(), id);
  if (found == obstacleIds_.end()) return;
  obstacles_[static_cast<std::size_t>(found - obstacleIds_.begin())].motion = motion;
  for (auto &[attachment, layer] : attachments_)
    if (layer->settings().second == id) layer->setMotion(motion);
  updateSurroundings();
}

Motion Simulator::motionAtReset(std::size_t id) const {
  if (const auto own = ownMotions_.find(id); own != ownMotions_.end()) return own->second;
  const Obstacle *found = obstacle(id);
  return found ? found->motion : Motion();
}

void Simulator::guideObstacle(std::size_t id, const RigidMotion &target, double duration) {
  POINTBASED_EXPECTS(
      target.rotation.allFinite() && target.centre.allFinite() && target.displacement.allFinite() && duration >= 0.0,
      "a finite place, and a time that is not negative");
  const Obstacle *found = obstacle(id);
  if (!found) return;
  const bool standsStill = instruments_.contains(id) || placed_.contains(id) || !motionAtReset(id);
  const bool begins = steps_ == 0 && standsStill;
  Motion motion = between(obstacleMotion(id), target, clockOfRamps(), begins ? 0.0 : duration);
  if (begins) {
    placed_.insert(id);
    ownMotions_.erase(id);
  } else {
    ownMotions_.emplace(id, found->motion);
  }
  setMotion(id, std::move(motion));
}

// Within a history epoch: only instruments, and the motions of all obstacles, may differ.
void Simulator::restoreObstacles(const detail::SimulatorCheckpoint &kept) {
  for (const std::size_t id : std::set<std::size_t>(instruments_))
    if (!kept.instruments.contains(id)) removeObstacle(id);
  obstacles_ = kept.obstacles;
  obstacleIds_ = kept.obstacleIds;
  instruments_ = kept.instruments;
  ownMotions_ = kept.ownMotions;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) setMotion(obstacleIds_[o], kept.obstacles[o].motion);
}

void Simulator::endGuidance() {
  for (const std::size_t id : std::set<std::size_t>(instruments_)) removeObstacle(id);
  for (const auto &[id, motion] : std::map<std::size_t, Motion>(ownMotions_)) setMotion(id, motion);
  ownMotions_.clear();
}

}  // namespace pointbased
