// SPDX-License-Identifier: Apache-2.0
#include "tools/move_tool.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pointbased {
namespace {

// x, y, z as elsewhere in the window.
constexpr std::array<sdk::Material, 3> kAxes{
    {{{0.90f, 0.30f, 0.28f, 1.0f}, false}, {{0.42f, 0.78f, 0.35f, 1.0f}, false}, {{0.36f, 0.55f, 0.95f, 1.0f}, false}}};
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kRing = 0.75;           // of the size of the handles
constexpr double kPickDistance = 0.07;   // of that size: distance at which a handle counts as under the mouse
constexpr double kMinSine = 0.15;        // sine: a ring or an arrow seen at a smaller angle cannot be dragged
constexpr double kMinSize = 0.015;       // m, of the handles
constexpr double kPoseTolerance = 1e-6;  // m, and for a rotation matrix
constexpr int kRingSegments = 48;

Vec3 unit(int axis) { return Vec3::Unit(axis); }

// Distance along a line through `at` to the point nearest to the ray; nothing if they are almost parallel.
std::optional<double> nearestAlong(const PickRay &ray, const Vec3 &at, const Vec3 &axis) {
  const double c = axis.dot(ray.direction);
  if (1.0 - c * c < kMinSine * kMinSine) return std::nullopt;
  const Vec3 off = at - ray.origin;
  return (c * off.dot(ray.direction) - off.dot(axis)) / (1.0 - c * c);
}

std::optional<Vec3> onPlane(const PickRay &ray, const Vec3 &at, const Vec3 &normal) {
  const double c = normal.dot(ray.direction);
  if (std::abs(c) < kMinSine) return std::nullopt;
  const double t = (at - ray.origin).dot(normal) / c;
  if (t <= 0.0) return std::nullopt;
  return ray.origin + t * ray.direction;
}

double distanceFrom(const PickRay &ray, const Vec3 &x) { return (x - ray.origin).cross(ray.direction).norm(); }

}  // namespace

Vec3 anglesOf(const Mat3 &R) {
  const Vec3 angles(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                    std::atan2(R(1, 0), R(0, 0)));
  return kDegrees * angles + Vec3::Zero();  // without -0
}

Mat3 rotationOf(const Vec3 &angles_deg) {
  const Vec3 a = angles_deg / kDegrees;
  return (Eigen::AngleAxisd(a[2], Vec3::UnitZ()) * Eigen::AngleAxisd(a[1], Vec3::UnitY()) *
          Eigen::AngleAxisd(a[0], Vec3::UnitX()))
      .toRotationMatrix();
}

MoveTool::MoveTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
    : InteractiveTool(services, std::move(steps)) {}

const ObstacleSnapshot *MoveTool::chosenObstacle(const std::shared_ptr<const Snapshot> &snapshot) const {
  const ObstacleSnapshot *found = snapshot && chosen_ != 0 ? snapshot->obstacle(chosen_) : nullptr;
  return found && !found->hasOwnMotion && !found->isInstrument ? found : nullptr;
}

void MoveTool::choose(std::uint64_t obstacle) {
  commit();
  drag_.reset();
  pose_.reset();
  hideHandles();
  chosen_ = obstacle;
  const std::shared_ptr<const Snapshot> snapshot = simulator_ ? simulator_->snapshot() : nullptr;
  const ObstacleSnapshot *found = chosenObstacle(snapshot);
  if (!found) {
    chosen_ = 0;
    return;
  }
  name_ = found->name;
  middleAtRest_ = found->middleAtRest();
  size_ = std::max(kMinSize, 0.6 * (found->mesh->max - found->mesh->min).norm());
  pose_ = ObstaclePose{found->middle(), found->motion.rotation};
}

void MoveTool::setPose(const ObstaclePose &pose) {
  if (!pose_) return;
  if (!isEdited_) history_.begin(simulator_);
  isEdited_ = true;
  pose_ = pose;
  sendPose();
}

void MoveTool::commit() {
  if (!isEdited_) return;
  isEdited_ = false;
  history_.end("move " + name_, InteractionHistory::Kind::placement);
}

void MoveTool::sendPose() {
  isMoving_ = true;
  simulator_->abandonLongStep();
  change([id = chosen_, motion = pose_->motionFrom(middleAtRest_)](const BodyQueries &queries) {
    return MoveObstacle{queries.nameOfObstacle(id), motion};
  });
}

bool MoveTool::onEvent(const c3de_event &event) {
  if (event.type == C3DE_EVENT_PRESS && event.button == C3DE_BUTTON_LEFT) return press(event);
  if (!drag_) return false;
  if (event.type == C3DE_EVENT_MOVE) {
    if (const auto ray = rayOf(services_, simulator_->node(), event)) drag(*ray);
    return true;
  }
  if (event.type == C3DE_EVENT_RELEASE && event.button == C3DE_BUTTON_LEFT) {
    cancel();
    return true;
  }
  return false;
}

std::optional<MoveTool::Drag> MoveTool::handleUnder(const PickRay &ray) const {
  if (!pose_) return std::nullopt;
  std::optional<Drag> best;
  double nearest = kPickDistance * size_;
  const auto consider = [&](Handle handle, int axis, const Vec3 &x) {
    const double away = distanceFrom(ray, x);
    if (away >= nearest) return;
    nearest = away;
    best = Drag{handle, axis, x, *pose_};
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (const auto along = nearestAlong(ray, pose_->middle, unit(axis)))
      if (*along > 0.3 * size_ && *along < 1.05 * size_)
        consider(Handle::along, axis, pose_->middle + *along * unit(axis));
    if (const auto at = onPlane(ray, pose_->middle, unit(axis))) {
      const Vec3 off = *at - pose_->middle;
      if (off.norm() > 0.5 * size_) consider(Handle::about, axis, pose_->middle + kRing * size_ * off.normalized());
    }
  }
  return best;
}

bool MoveTool::press(const c3de_event &event) {
  if (!simulator_ || drag_) return false;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  commit();
  drag_ = handleUnder(*ray);
  if (!drag_) {
    const std::optional<PickedSurface> picked = pick(services_, *snapshot, *ray);
    if (!picked || !picked->obstacle) return false;
    choose(picked->obstacle->id);
    if (!pose_) return false;
    drag_ = Drag{Handle::free, 0, picked->at, *pose_};
  }
  history_.begin(simulator_);
  return true;
}

void MoveTool::drag(const PickRay &ray) {
  ObstaclePose pose = drag_->from;
  const Vec3 axis = unit(drag_->axis);
  switch (drag_->handle) {
    case Handle::free:
      if (const auto at = ray.onScreenPlane(drag_->point)) pose.middle += *at - drag_->point;
      break;
    case Handle::along:
      if (const auto along = nearestAlong(ray, drag_->point, axis)) pose.middle += *along * axis;
      break;
    case Handle::about:
      if (const auto at = onPlane(ray, pose.middle, axis)) {
        const Vec3 before = drag_->point - pose.middle, now = *at - pose.middle;
        const double angle = std::atan2(axis.dot(before.cross(now)), before.dot(now));
        pose.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * pose.rotation;
      }
      break;
  }
  pose_ = pose;
  sendPose();
}

void MoveTool::cancel() {
  commit();
  if (!drag_) return;
  drag_.reset();
  history_.end("move " + name_, InteractionHistory::Kind::placement);
}

void MoveTool::hideHandles() {
  for (auto *handles : {&arrows_, &rings_})
    for (sdk::Proxy &handle : *handles) handle.reset();
  label_.reset();
}

void MoveTool::showHandles() {
  if (!services_.render) return;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 &at = pose_->middle, along = unit(axis), u = unit((axis + 1) % 3), v = unit((axis + 2) % 3);
    const Vec3 tip = at + size_ * along;
    std::vector<Vec3> points{at, tip};
    for (const Vec3 &side : {u, Vec3(-u), v, Vec3(-v)})
      points.insert(points.end(), {tip, tip - 0.12 * size_ * along + 0.05 * size_ * side});
    showLines(arrows_[static_cast<std::size_t>(axis)], points, kAxes[static_cast<std::size_t>(axis)]);
    points.clear();
    const auto onRing = [&](int k) {
      const double turn = 2.0 * std::numbers::pi * k / kRingSegments;
      return Vec3(at + kRing * size_ * (std::cos(turn) * u + std::sin(turn) * v));
    };
    for (int k = 0; k < kRingSegments; ++k) points.insert(points.end(), {onRing(k), onRing(k + 1)});
    showLines(rings_[static_cast<std::size_t>(axis)], points, kAxes[static_cast<std::size_t>(axis)]);
  }
}

void MoveTool::update() {
  history_.update();
  if (!simulator_) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const ObstacleSnapshot *obstacle = chosenObstacle(snapshot);
  if (chosen_ == 0 || !obstacle) {
    if (chosen_ != 0) choose(0);
    return;
  }
  // Undo or a reset may have moved it elsewhere.
  const bool hasArrived = (obstacle->middle() - pose_->middle).norm() < kPoseTolerance &&
                          (obstacle->motion.rotation - pose_->rotation).norm() < kPoseTolerance;
  if (hasArrived || snapshot->steps < steps_) isMoving_ = false;
  steps_ = snapshot->steps;
  const std::string idle = drag_ && snapshot->steps > 0 ? idleReason() : std::string();
  if (idle.empty() || !services_.render)
    label_.reset();
  else
    showLabel(label_, pose_->middle, idle, kForce);
  if (!drag_ && !isEdited_ && !isMoving_) pose_ = ObstaclePose{obstacle->middle(), obstacle->motion.rotation};
  if (isActive())
    showHandles();
  else
    hideHandles();
}

}  // namespace pointbased
