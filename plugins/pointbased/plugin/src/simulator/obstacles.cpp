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
  const std::lock_guard lock(world_.mutex);
  world_.reset();
  const std::uint64_t id = simulator_.addObstacle(std::move(built));
  table_.addObstacle(id, std::move(record));
  if (out) *out = {id};
}

void Obstacles::placeInstrument(ProbeTool tool) {
  const std::lock_guard lock(world_.mutex);
  tool.name = table_.freeInstrumentName();
  tool.path.resize(1, tool.path.empty() ? ToolPose() : tool.path.front());
  tool.path.push_back(tool.path.front());
  tool.path.back().time = tool.path.front().time + 1.0;
  auto built = obstacleOf(tool);
  if (!built) throw Error(C3DE_E_ARG, built.error());
  const ObstacleRecord record{tool.name, meshOf(world_.context.services, tool), tool.friction, 0.0, {}, tool};
  eraseInstruments();
  const std::uint64_t id = simulator_.world().addInstrument(std::move(*built));
  table_.addInstrument(id, record);
}

void Obstacles::moveInstrument(const Vec3 &middle) {
  const std::lock_guard lock(world_.mutex);
  for (const auto &[id, record] : table_.obstacles()) {
    if (!simulator_.world().isInstrument(id)) continue;
    const Vec3 &at = record.tool->path.front().at;
    guideWithSpeedLimit(id, {Mat3::Identity(), at, middle - at});
  }
}

void Obstacles::removeInstrument() {
  const std::lock_guard lock(world_.mutex);
  eraseInstruments();
}

void Obstacles::eraseInstruments() {
  for (const std::uint64_t id : table_.removeInstruments()) simulator_.removeObstacle(id);
}

void Obstacles::guide(std::uint64_t obstacle, const RigidMotion &target) {
  const std::lock_guard lock(world_.mutex);
  guideWithSpeedLimit(obstacle, target);
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

void Obstacles::extractObstacle(RemovedObstacle &removed) {
  const std::lock_guard lock(world_.mutex);
  const ObstacleRecord *record = table_.obstacle(removed.id);
  const Obstacle *obstacle = simulator_.world().obstacle(removed.id);
  if (!record || !obstacle) return;
  removed.record = *record;
  removed.obstacle = *obstacle;
  removed.obstacle.motion = simulator_.world().motionAtReset(removed.id);
  removed.pose = simulator_.world().obstacleMotion(removed.id);
  removed.pairs.clear();
  for (const auto &[pair, settings] : simulator_.world().contactPairs())
    if (pair.first == removed.id || pair.second == removed.id) removed.pairs.emplace(pair, settings);
  removed.attachments = table_.attachmentsOf(removed.id);
  table_.removeObstacle(removed.id);
  simulator_.removeObstacle(removed.id);
}

bool Obstacles::reinsertObstacle(RemovedObstacle &removed) {
  const std::lock_guard lock(world_.mutex);
  if (!removed.record) return false;
  // Before the first step it is placed again below; afterwards a reset moves it to its initial position.
  if (!removed.record->motion && simulator_.steps() == 0) removed.obstacle.motion = nullptr;
  const std::uint64_t before = std::exchange(removed.id, simulator_.addObstacle(removed.obstacle));
  const std::uint64_t id = removed.id;
  table_.addObstacle(id, *std::exchange(removed.record, std::nullopt));
  // An obstacle moved by the scene follows its motion; one that has not been moved is where it was built.
  const bool isElsewhere =
      removed.obstacle.motion || !removed.pose.rotation.isIdentity(0.0) || !removed.pose.displacement.isZero(0.0);
  if (!table_.obstacle(id)->motion && isElsewhere) simulator_.world().guideObstacle(id, removed.pose, 0.0);
  for (const auto &[pair, settings] : removed.pairs)
    simulator_.world().setContactPair(id, pair.first == before ? pair.second : pair.first, settings);
  const bool isReset = simulator_.steps() > 0 && (!removed.attachments.empty() || containsSkin(simulator_, table_, id));
  if (isReset || !removed.attachments.empty()) world_.reset();
  for (const Attachment &attachment : removed.attachments) attachments_.reattach(attachment, before, id);
  return isReset;
}

RemovedObstacle Obstacles::prepare(const std::string &name, c3de_handle mesh, const Placement &placement) {
  const ParameterValues values(obstacleDeclarations());
  auto placed = placeMesh(world_.context.services, mesh, placement);
  RemovedObstacle removed;
  removed.obstacle = buildObstacle(world_.context.services, name, placed,
                                   {values.number("friction"), values.number("restitution")}, std::nullopt);
  removed.record = ObstacleRecord{name, std::move(placed), removed.obstacle.friction, removed.obstacle.restitution, {}};
  return removed;
}

}  // namespace pointbased
