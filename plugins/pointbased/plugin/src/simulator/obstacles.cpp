// SPDX-License-Identifier: Apache-2.0
#include "simulator/obstacles.h"

#include <algorithm>
#include <utility>

#include "c3de/sdk/structs.hpp"
#include "instruments/probe_tool_mesh.h"
#include "simulator/obstacle_overlap.h"

namespace pointbased {
namespace {

using sdk::Error;

// m/s and rad/s of simulated time: slower than what a step of contact can follow, faster than a careful hand.
constexpr double kMaxSpeed = 0.5, kMaxTurn = 5.0;
// s: mouse positions arrive about thirty times a second; the motion between them is uniform.
constexpr double kMinTime = 1.0 / 30.0;

}  // namespace

void Obstacles::add(const c3de_sim_obstacle *obstacle, c3de_handle *out) {
  const c3de_sim_obstacle in = sdk::readStruct(obstacle, "obstacle");
  ParameterValues values(obstacleDeclarations());
  sdk::orThrow(values.set(in.params, in.params_n, in.params_stride));
  const std::string name(sdk::text(in.name));
  auto mesh = placeMesh(world_.context.services, in.mesh, readPlacement(in.placement));
  Obstacle built =
      buildObstacle(world_.context.services, name, mesh, {values.number("friction"), values.number("restitution")},
                    readMotion(in.motion, "obstacle"));
  ObstacleRecord record{name, std::move(mesh), built.friction, built.restitution, built.motion};
  const StateLock lock(world_);
  world_.reset();
  const std::uint64_t id = simulator_.addObstacle(std::move(built));
  table_.addObstacle(id, std::move(record));
  if (out) *out = {id};
}

void Obstacles::placeInstrument(ChangeAccess, ProbeTool tool) {
  tool.name = table_.freeInstrumentName();
  auto [built, record] = instrumentOf(std::move(tool));
  eraseInstruments();
  const std::uint64_t id = simulator_.world().addInstrument(std::move(built));
  table_.addInstrument(id, record);
}

std::vector<SavedInstrument> Obstacles::savedInstruments() const {
  std::vector<SavedInstrument> all;
  for (const auto &[id, record] : table_.obstacles()) {
    if (!simulator_.world().isInstrument(id)) continue;
    const ProbeTool &tool = *record.tool;
    all.push_back({tool.name, tool.radius, tool.length, tool.friction, tool.path.front()});
  }
  return all;
}

Obstacles::RestoredInstruments Obstacles::prepare(const std::vector<SavedInstrument> &saved) const {
  RestoredInstruments all;
  for (const SavedInstrument &one : saved) {
    requireFinite("the instrument", one.radius, one.length, one.friction, one.pose.time, one.pose.at, one.pose.axis);
    auto [obstacle, record] = instrumentOf({one.name, one.radius, one.length, one.friction, {one.pose}});
    all.obstacles.push_back(std::move(obstacle));
    all.records.push_back(std::move(record));
  }
  return all;
}

// At rest in the first pose of its path.
std::pair<Obstacle, ObstacleRecord> Obstacles::instrumentOf(ProbeTool tool) const {
  tool.path.resize(1, tool.path.empty() ? ToolPose() : tool.path.front());
  tool.path.push_back(tool.path.front());
  tool.path.back().time = tool.path.front().time + 1.0;
  auto built = obstacleOf(tool);
  if (!built) throw Error(C3DE_E_ARG, built.error());
  return {std::move(*built), {tool.name, meshOf(world_.context.services, tool), tool.friction, 0.0, {}, tool}};
}

void Obstacles::moveInstrument(ChangeAccess, const Vec3 &middle) {
  for (const auto &[id, record] : table_.obstacles()) {
    if (!simulator_.world().isInstrument(id)) continue;
    const Vec3 &at = record.tool->path.front().at;
    guideWithSpeedLimit(id, {Mat3::Identity(), at, middle - at});
  }
}

void Obstacles::eraseInstruments() {
  for (const std::uint64_t id : table_.removeInstruments()) simulator_.removeObstacle(id);
}

void Obstacles::guideWithSpeedLimit(std::uint64_t obstacle, const RigidMotion &target) {
  const ObstacleRecord *record = table_.obstacle(obstacle);
  if (!record) return;
  const RigidMotion now = simulator_.world().obstacleMotion(obstacle);
  // The corners of its box have the largest displacement.
  double distance = 0.0;
  const Vec3 &low = record->mesh->min, &high = record->mesh->max;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 x((corner & 1) ? high[0] : low[0], (corner & 2) ? high[1] : low[1], (corner & 4) ? high[2] : low[2]);
    distance = std::max(distance, (target.displacementOf(x) - now.displacementOf(x)).norm());
  }
  const double turn = Eigen::AngleAxisd(target.rotation * now.rotation.transpose()).angle();
  simulator_.world().guideObstacle(obstacle, target, std::max({kMinTime, distance / kMaxSpeed, turn / kMaxTurn}));
}

RemovedObstacle Obstacles::build(const std::string &name, c3de_handle mesh, const Placement &placement,
                                 const ObstacleSurface &surface) const {
  auto placed = placeMesh(world_.context.services, mesh, placement);
  RemovedObstacle built;
  built.obstacle = buildObstacle(world_.context.services, name, placed, surface, std::nullopt);
  built.record = ObstacleRecord{name, std::move(placed), surface.friction, surface.restitution, {}};
  return built;
}

std::uint64_t Obstacles::insert(const RemovedObstacle &what) {
  const std::uint64_t id = simulator_.addObstacle(what.obstacle);
  table_.addObstacle(id, what.record);
  return id;
}

void Obstacles::resetIfOverlapping(std::uint64_t obstacle, bool isAttached) {
  if (isAttached || (simulator_.steps() > 0 && containsSkin(simulator_, table_, obstacle))) world_.reset();
}

std::uint64_t Obstacles::addBuilt(ChangeAccess, const RemovedObstacle &built) {
  const std::uint64_t id = insert(built);
  resetIfOverlapping(id, false);
  return id;
}

void Obstacles::remove(ChangeAccess, std::uint64_t id) {
  const ObstacleRecord &record = *table_.obstacle(id);
  RemovedObstacle out;
  out.id = id;
  out.record = record;
  out.obstacle = *simulator_.world().obstacle(id);
  out.obstacle.motion = simulator_.world().motionAtReset(id);
  out.pose = simulator_.world().obstacleMotion(id);
  for (const auto &[pair, settings] : simulator_.world().contactPairs())
    if (pair.first == id || pair.second == id) out.pairs.emplace(pair, settings);
  out.attachments = table_.attachmentsOf(id);
  removed_.insert_or_assign(record.identity(), std::move(out));
  table_.removeObstacle(id);
  simulator_.removeObstacle(id);
}

const RemovedObstacle *Obstacles::removed(const ObjectName &name) const {
  const auto found = removed_.find(name);
  return found == removed_.end() ? nullptr : &found->second;
}

void Obstacles::restore(ChangeAccess, const RestoreObstacle &what) {
  const auto found = removed_.find(what.obstacle);
  RemovedObstacle obstacle = std::move(found->second);
  removed_.erase(found);
  const RestoreObstacle::Pose &pose = *what.pose;
  // Before the first step it is placed again below; afterwards a reset moves it to its initial position.
  if (!obstacle.record.motion && pose.isInitial) obstacle.obstacle.motion = nullptr;
  const std::uint64_t before = obstacle.id, id = insert(obstacle);
  // An obstacle moved by the scene follows its motion; one that has not been moved is where it was built.
  const bool isElsewhere =
      obstacle.obstacle.motion || !pose.motion.rotation.isIdentity(0.0) || !pose.motion.displacement.isZero(0.0);
  // A pose that was assigned after the first step is lost by a reset. Where only lasting changes are repeated, there
  // are no steps yet, and it must not become the initial pose.
  const bool isOfThisState = pose.isInitial || simulator_.steps() > 0;
  if (!obstacle.record.motion && isElsewhere && isOfThisState) simulator_.world().guideObstacle(id, pose.motion, 0.0);
  for (const auto &[pair, settings] : obstacle.pairs)
    simulator_.world().setContactPair(id, pair.first == before ? pair.second : pair.first, settings);
  resetIfOverlapping(id, !obstacle.attachments.empty());
  for (const Attachment &attachment : obstacle.attachments) attachments_.reattach(attachment, before, id);
}

}  // namespace pointbased
