// SPDX-License-Identifier: Apache-2.0
// What a hand leads: the instrument, and obstacles that are placed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "probe_tool_mesh.h"
#include "world_simulator.h"

namespace pointbased {
namespace {

using sdk::Error;

// m/s and rad/s of simulated time: slower than what a step of contact follows, faster than a careful hand.
constexpr double kMostSpeed = 0.5, kMostTurn = 5.0;
// s: a hand's places come about thirty times a second; between them it goes on evenly.
constexpr double kLeastTime = 1.0 / 30.0;
constexpr double kTouching = 5e-4;  // m: skin that is less deep in an obstacle touches it

}  // namespace

void WorldSimulator::placeInstrument(ProbeTool tool) {
  const std::lock_guard lock(mutex_);
  tool.name = table_.freeInstrumentName();
  tool.path.resize(1, tool.path.empty() ? ToolPlace() : tool.path.front());
  tool.path.push_back(tool.path.front());
  tool.path.back().time = tool.path.front().time + 1.0;
  auto built = obstacleOf(tool);
  if (!built) throw Error(C3DE_E_ARG, built.error());
  const ObstacleRecord record{tool.name, meshOf(context_.services, tool), tool.friction, 0.0, {}, tool};
  takeInstrumentAway();
  const std::uint64_t id = simulator_.addInstrument(std::move(*built));
  table_.addInstrument(id, record);
}

void WorldSimulator::moveInstrument(const Vec3 &middle) {
  const std::lock_guard lock(mutex_);
  for (const auto &[id, record] : table_.obstacles()) {
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
  for (const std::uint64_t id : table_.removeInstruments()) simulator_.removeObstacle(id);
}

void WorldSimulator::guide(std::uint64_t obstacle, const RigidMotion &target) {
  const std::lock_guard lock(mutex_);
  lead(obstacle, target);
}

void WorldSimulator::lead(std::uint64_t obstacle, const RigidMotion &target) {
  const ObstacleRecord *record = table_.obstacle(obstacle);
  if (!record) return;
  const RigidMotion now = simulator_.obstacleMotion(obstacle);
  // The corners of its box go farthest.
  double way = 0.0;
  const Vec3 &low = record->mesh->min, &high = record->mesh->max;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 x((corner & 1) ? high[0] : low[0], (corner & 2) ? high[1] : low[1], (corner & 4) ? high[2] : low[2]);
    way = std::max(way, (target.displacementOf(x) - now.displacementOf(x)).norm());
  }
  const double turn = Eigen::AngleAxisd(target.rotation * now.rotation.transpose()).angle();
  simulator_.guideObstacle(obstacle, target, std::max({kLeastTime, way / kMostSpeed, turn / kMostTurn}));
}

void WorldSimulator::takeOut(TakenObstacle &taken) {
  const std::lock_guard lock(mutex_);
  const ObstacleRecord *record = table_.obstacle(taken.id);
  const Obstacle *obstacle = simulator_.obstacle(taken.id);
  if (!record || !obstacle) return;
  taken.record = *record;
  taken.obstacle = *obstacle;
  taken.obstacle.motion = simulator_.motionAtReset(taken.id);
  taken.place = simulator_.obstacleMotion(taken.id);
  taken.pairs.clear();
  for (const auto &[pair, settings] : simulator_.contactPairs())
    if (pair.first == taken.id || pair.second == taken.id) taken.pairs.emplace(pair, settings);
  taken.attachments = table_.attachmentsOf(taken.id);
  table_.removeObstacle(taken.id);
  simulator_.removeObstacle(taken.id);
}

void WorldSimulator::putBack(TakenObstacle &taken) {
  const std::lock_guard lock(mutex_);
  if (!taken.record) return;
  // Before the first step it is placed anew below; after it, a reset brings it to where it began.
  if (!taken.record->motion && simulator_.steps() == 0) taken.obstacle.motion = nullptr;
  const std::uint64_t before = std::exchange(taken.id, simulator_.addObstacle(taken.obstacle));
  const std::uint64_t id = taken.id;
  table_.addObstacle(id, *std::exchange(taken.record, std::nullopt));
  // One that the scene moves is where its motion has it.
  if (!table_.obstacle(id)->motion) simulator_.guideObstacle(id, taken.place, 0.0);
  for (const auto &[pair, settings] : taken.pairs)
    simulator_.setContactPair(id, pair.first == before ? pair.second : pair.first, settings);
  if (!taken.attachments.empty() || holdsSkin(id)) resetSimulator();
  for (const Attachment &attachment : taken.attachments) attachAgain(attachment, before, id);
}

// m, of points from the surface of an obstacle where it is now; inside below 0, infinite where they are `near` or more
// off its box.
std::vector<double> WorldSimulator::distancesFrom(std::uint64_t id, std::span<const Vec3> points, double near) const {
  std::vector<double> distances(points.size(), std::numeric_limits<double>::infinity());
  const Obstacle *obstacle = simulator_.obstacle(id);
  if (!obstacle || !obstacle->closest) return distances;
  const RigidMotion motion = simulator_.obstacleMotion(id);
  const PlacedMesh &mesh = *table_.obstacle(id)->mesh;
  std::vector<Vec3> places;  // in its frame at rest
  std::vector<std::size_t> which;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 at = motion.rotation.transpose() * (points[k] - motion.centre - motion.displacement) + motion.centre;
    if ((at.array() < mesh.min.array() - near).any() || (at.array() > mesh.max.array() + near).any()) continue;
    places.push_back(at);
    which.push_back(k);
  }
  const std::vector<double> ranges(places.size(), (mesh.max - mesh.min).norm());
  std::vector<SurfacePoint> found(places.size());
  obstacle->closest(places, ranges, found);
  for (std::size_t k = 0; k < places.size(); ++k) distances[which[k]] = found[k].distance;
  return distances;
}

// m³, of tissue that lay in the reference where an obstacle is now: evaluation points with their volumes, at its
// surface by the part of a cell that is in it.
double WorldSimulator::displacedVolume(std::uint64_t id) const {
  double sum = 0.0;
  for (const auto &[body, record] : table_.bodies()) {
    const RestState &rest = simulator_.body(body)->rest();
    std::vector<Vec3> places(rest.pointCentres.begin(), rest.pointCentres.end());
    for (Vec3 &x : places) x += rest.origin;
    const std::vector<double> &volumes = rest.stencils.volumes;
    const double largest = volumes.empty() ? 0.0 : *std::max_element(volumes.begin(), volumes.end());
    const std::vector<double> distances = distancesFrom(id, places, 0.5 * std::cbrt(largest));
    for (std::size_t q = 0; q < places.size(); ++q)
      sum += volumes[q] * std::clamp(0.5 - distances[q] / std::cbrt(volumes[q]), 0.0, 1.0);
  }
  return sum;
}

// Whether skin lies in an obstacle that has just come: contact would lead some of it out to the wrong side.
bool WorldSimulator::holdsSkin(std::uint64_t id) {
  return std::any_of(table_.bodies().begin(), table_.bodies().end(), [&](const auto &entry) {
    std::vector<Vec3> positions, normals;
    simulator_.surfels(entry.first, positions, normals);
    const std::vector<double> distances = distancesFrom(id, positions, 0.0);
    return std::any_of(distances.begin(), distances.end(), [](double d) { return d < -kTouching; });
  });
}

void WorldSimulator::resetSimulator() {
  simulator_.reset();
  resetGrasps();
  table_.followInstruments(simulator_);
  table_.forgetInstruments();
}

}  // namespace pointbased
