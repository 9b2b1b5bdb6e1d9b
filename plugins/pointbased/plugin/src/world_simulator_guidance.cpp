// SPDX-License-Identifier: Apache-2.0
// What a hand leads: the instrument, and obstacles that are placed.
#include <algorithm>
#include <cmath>

#include "probe_tool_mesh.h"
#include "world_simulator.h"

namespace pointbased {
namespace {

using sdk::Error;

// m/s and rad/s of simulated time: slower than what a step of contact follows, faster than a careful hand.
constexpr double kMostSpeed = 0.5, kMostTurn = 5.0;
// s: a hand's places come about thirty times a second; between them it goes on evenly.
constexpr double kLeastTime = 1.0 / 30.0;

}  // namespace

void WorldSimulator::placeInstrument(ProbeTool tool) {
  const std::lock_guard lock(mutex_);
  const auto isTaken = [this](const std::string &name) {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [&](const auto &one) { return one.second.name == name && !simulator_.isInstrument(one.first); });
  };
  tool.name = "instrument";
  for (int k = 2; isTaken(tool.name); ++k) tool.name = "instrument " + std::to_string(k);
  tool.path.resize(1, tool.path.empty() ? ToolPlace() : tool.path.front());
  tool.path.push_back(tool.path.front());
  tool.path.back().time = tool.path.front().time + 1.0;
  auto built = obstacleOf(tool);
  if (!built) throw Error(C3DE_E_ARG, built.error());
  ObstacleRecord record{tool.name, meshOf(context_.services, tool), tool.friction, 0.0, {}, tool};
  takeInstrumentAway();
  const std::uint64_t id = simulator_.addInstrument(std::move(*built));
  obstacles_.emplace(id, record);
  placedInstruments_.emplace(id, std::move(record));
}

void WorldSimulator::moveInstrument(const Vec3 &middle) {
  const std::lock_guard lock(mutex_);
  for (const auto &[id, record] : obstacles_) {
    if (!simulator_.isInstrument(id)) continue;
    const Vec3 &at = record.tool->path.front().at;
    lead(id, {Mat3::Identity(), at, middle - at});
  }
}

void WorldSimulator::removeInstrument() {
  const std::lock_guard lock(mutex_);
  takeInstrumentAway();
}

void WorldSimulator::takeInstrumentAway() {
  for (const auto &[id, record] : placedInstruments_)
    if (obstacles_.erase(id) > 0) simulator_.removeObstacle(id);
}

void WorldSimulator::guide(std::uint64_t obstacle, const RigidMotion &target) {
  const std::lock_guard lock(mutex_);
  lead(obstacle, target);
}

void WorldSimulator::lead(std::uint64_t obstacle, const RigidMotion &target) {
  const auto found = obstacles_.find(obstacle);
  if (found == obstacles_.end()) return;
  const RigidMotion now = simulator_.obstacleMotion(obstacle);
  // The corners of its box go farthest.
  double way = 0.0;
  const Vec3 &low = found->second.mesh->min, &high = found->second.mesh->max;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 x((corner & 1) ? high[0] : low[0], (corner & 2) ? high[1] : low[1], (corner & 4) ? high[2] : low[2]);
    way = std::max(way, (target.displacementOf(x) - now.displacementOf(x)).norm());
  }
  const double turn = Eigen::AngleAxisd(target.rotation * now.rotation.transpose()).angle();
  simulator_.guideObstacle(obstacle, target, std::max({kLeastTime, way / kMostSpeed, turn / kMostTurn}));
}

// m³, of tissue that lay in the reference where an obstacle is now: evaluation points with their volumes, at its
// surface by the part of a cell that is in it.
double WorldSimulator::displacedVolume(std::uint64_t id) const {
  const Obstacle *obstacle = simulator_.obstacle(id);
  if (!obstacle || !obstacle->closest) return 0.0;
  const RigidMotion motion = simulator_.obstacleMotion(id);
  const PlacedMesh &mesh = *obstacles_.at(id).mesh;
  std::vector<Vec3> places;  // in its frame at rest
  std::vector<double> volumes;
  for (const auto &[body, record] : bodies_) {
    const RestState &rest = simulator_.body(body)->rest();
    for (std::size_t q = 0; q < rest.pointCount(); ++q) {
      const Vec3 x = rest.origin + rest.pointCentres[q] - motion.centre - motion.displacement;
      const Vec3 at = motion.rotation.transpose() * x + motion.centre;
      const double half = 0.5 * std::cbrt(rest.stencils.volumes[q]);
      if ((at.array() < mesh.min.array() - half).any() || (at.array() > mesh.max.array() + half).any()) continue;
      places.push_back(at);
      volumes.push_back(rest.stencils.volumes[q]);
    }
  }
  const std::vector<double> ranges(places.size(), (mesh.max - mesh.min).norm());
  std::vector<SurfacePoint> found(places.size());
  obstacle->closest(places, ranges, found);
  double sum = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k)
    sum += volumes[k] * std::clamp(0.5 - found[k].distance / std::cbrt(volumes[k]), 0.0, 1.0);
  return sum;
}

// After the simulator has gone to another state: its instruments are those of then.
void WorldSimulator::followInstruments() {
  for (const auto &[id, record] : placedInstruments_) {
    if (simulator_.obstacle(id))
      obstacles_.emplace(id, record);
    else
      obstacles_.erase(id);
  }
}

void WorldSimulator::resetSimulator() {
  simulator_.reset();
  resetGrasps();
  followInstruments();
  placedInstruments_.clear();
}

}  // namespace pointbased
