// SPDX-License-Identifier: Apache-2.0
#include "tools/grasp_tool.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr sdk::Material kTargetLine{{0.9f, 0.9f, 0.9f, 1.0f}, false};
constexpr double kDegreesPerNotch = 5.0;  // degrees, per notch of the wheel
constexpr double kSpacings = 2.0;         // default size of jaws in spacings
constexpr double kOpeningInJaws = 2.0;    // default opening in jaw sizes
constexpr double kMinMousePixels = 2.0;   // between two mouse positions
constexpr double kTolerance = 1e-9;       // m, and for directions
constexpr double kTargetDistance = 1e-3;  // m: the target differs from the present position

void warn(const Services &services, std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  (void)services.notifier.notify(C3DE_LOG_WARN, "Grasp", text);
}

}  // namespace

void GraspTool::setSettings(const GraspSettings &settings) {
  if (settings == settings_) return;
  settings_ = settings;
  isChosen_ = true;
}

bool GraspTool::onEvent(const c3de_event &event) {
  if (!simulator_) return false;
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  switch (event.type) {
    case C3DE_EVENT_PRESS: return event.button == C3DE_BUTTON_LEFT && press(event);
    case C3DE_EVENT_MOVE:
      if (drag_ && ray) drag(*ray);
      if (ray) recordMouse(event, *ray);
      return drag_.has_value();
    case C3DE_EVENT_WHEEL:
      if (!drag_ || !ray) return false;
      rotate(*ray, kDegreesPerNotch * event.wheel);
      return true;
    case C3DE_EVENT_RELEASE:
      if (!drag_ || event.button != C3DE_BUTTON_LEFT) return false;
      release();
      return true;
    case C3DE_EVENT_KEY:
      if (!pose_ || event.key != 'X') return false;
      releaseGrasp();
      return true;
    default: return false;
  }
}

bool GraspTool::press(const c3de_event &event) {
  if (drag_) return false;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  if (pose_ && isOnJaw(*snapshot, *ray)) {
    const std::optional<Vec3> at = ray->onScreenPlane(pose_->middle);
    if (!at) return false;
    history_.begin(simulator_);
    drag_ = Drag{*at, pose_->middle - *at};
    return true;
  }
  const std::optional<PickedSurface> picked = pick(services_, *snapshot, *ray);
  return picked && picked->body && graspAt(*snapshot, *picked, *ray);
}

bool GraspTool::graspAt(const Snapshot &snapshot, const PickedSurface &picked, const PickRay &ray) {
  const BodySnapshot &body = *picked.body;
  if (warnIfQuasiStatic(snapshot, "Grasp", "jaws could pull")) return true;
  if (body.isStatic) {
    warn(services_, body.name + " is rigid and cannot be pulled. Set Surroundings, Free to let it move");
    return true;
  }
  const GraspSettings settings = settingsOn(body);
  std::string problem = problemOf(settings);
  Result<JawPositions> jaws = JawPositions();
  if (problem.empty()) {
    Surface skin;
    skin.triangles = body.surface->triangles;
    skin.positions.reserve(body.surfels.size());
    for (const Vec3f &x : body.surfels) skin.positions.push_back(vectorOf(x));
    jaws = findJaws(skin, picked.at, picked.normal, screenRightAt(picked.at, ray.view), settings);
    problem = jaws ? problemOf(*body.rest, *jaws, settings) : jaws.error();
  }
  if (!problem.empty()) {
    warn(services_, problem);
    return true;
  }
  settings_ = settings;
  history_.begin(simulator_);
  forces_.clear();
  pose_.reset();
  isPending_ = true;
  drag_ = Drag{picked.at, Vec3::Zero()};
  simulator_->abandonLongStep();
  change([id = body.id, at = *jaws, settings](const BodyQueries &queries) {
    return BeginGrasp{queries.nameOfBody(id), at, settings};
  });
  return true;
}

// Not set by the user: smaller jaws would hold only a point or two.
GraspSettings GraspTool::settingsOn(const BodySnapshot &body) const {
  GraspSettings settings = settings_;
  if (isChosen_) return settings;
  settings.jaw = std::max(settings.jaw, 1e-3 * std::ceil(1e3 * kSpacings * body.rest->spacing));
  settings.opening = std::max(settings.opening, kOpeningInJaws * settings.jaw);
  settings.closed = std::max(settings.closed, 0.5 * settings.opening);
  return settings;
}

bool GraspTool::isOnJaw(const Snapshot &snapshot, const PickRay &ray) const {
  const GraspSnapshot *grasp = snapshot.interactiveGrasp();
  const BodySnapshot *body = grasp ? snapshot.body(grasp->body) : nullptr;
  return body && std::any_of(grasp->points.begin(), grasp->points.end(), [&](const SkinPoint &point) {
           const Vec3 off = point.at(body->surfels) - ray.origin;
           return off.cross(ray.direction).norm() < 0.6 * grasp->settings.jaw;
         });
}

void GraspTool::recordMouse(const c3de_event &event, const PickRay &ray) {
  if (mouse_ && std::hypot(event.x_px - mouse_->event.x_px, event.y_px - mouse_->event.y_px) < kMinMousePixels) return;
  previousMouse_ = std::exchange(mouse_, MouseSample{event, ray});
}

// From two mouse positions, which are known on the screen and in space. Without them, from the direction in which y is
// up.
Vec3 GraspTool::screenRightAt(const Vec3 &point, const Vec3 &view) const {
  if (previousMouse_ && mouse_) {
    const PickRay &a = previousMouse_->ray, &b = mouse_->ray;
    const std::optional<Vec3> from = a.onScreenPlane(point), to = b.onScreenPlane(point);
    const bool isOfThisView = (a.view - view).norm() < kTolerance && (b.view - view).norm() < kTolerance &&
                              (a.origin - b.origin).norm() < kTolerance;
    if (isOfThisView && from && to)
      return screenRight(*to - *from, mouse_->event.x_px - previousMouse_->event.x_px,
                         mouse_->event.y_px - previousMouse_->event.y_px, view);
  }
  const Vec3 right = view.cross(Vec3::UnitY());
  return right.norm() > kTolerance ? Vec3(right.normalized()) : Vec3(Vec3::UnitX());
}

void GraspTool::drag(const PickRay &ray) {
  if (!pose_) return;
  const std::optional<Vec3> at = ray.onScreenPlane(drag_->point);
  if (!at) return;
  pose_->middle = *at + drag_->offset;
  sendPose();
}

void GraspTool::rotate(const PickRay &ray, double degrees) {
  if (!pose_) return;
  pose_->rotation =
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, ray.view).toRotationMatrix() * pose_->rotation;
  sendPose();
}

void GraspTool::sendPose() {
  change([pose = *pose_](const BodyQueries &) { return MoveGrasp{pose.middle, pose.rotation}; });
}

void GraspTool::release() {
  if (!drag_) return;
  drag_.reset();
  history_.end("grasp");
}

void GraspTool::cancel() { release(); }

void GraspTool::releaseGrasp() {
  if (simulator_) simulator_->abandonLongStep();
  change([](const BodyQueries &) { return ReleaseGrasp(); });
  clear();
}

void GraspTool::clear() {
  release();
  pose_.reset();
  isPending_ = false;
  for (sdk::Proxy *proxy : {&arrow_, &targetLine_, &label_}) proxy->reset();
}

void GraspTool::update() {
  history_.update();
  if (!simulator_) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const GraspSnapshot *grasp = snapshot ? snapshot->interactiveGrasp() : nullptr;
  const BodySnapshot *body = grasp ? snapshot->body(grasp->body) : nullptr;
  if (!body) {
    // Released by a reset or by undo.
    if (pose_ && !isPending_) clear();
    return;
  }
  if (!pose_ && drag_) {
    // The middle of the patches differs from the position under the mouse.
    drag_->offset = grasp->middle - drag_->point;
  }
  isPending_ = false;
  if (!pose_ || !drag_) pose_ = Pose{grasp->middle, grasp->rotation};
  forces_.addSample(grasp->forces.pull.norm(), snapshot->time);
  if (!services_.render) return;
  const Vec3 middle = 0.5 * (grasp->points[0].at(body->surfels) + grasp->points[1].at(body->surfels));
  const Vec3 tip = showArrow(arrow_, grasp->hinge(*body), grasp->forces.pull, forces_.largest());
  if ((pose_->middle - middle).norm() > kTargetDistance)
    showLines(targetLine_, std::array<Vec3, 2>{middle, pose_->middle}, kTargetLine);
  else
    targetLine_.reset();
  const std::string idle = drag_ ? idleReason() : std::string();
  showLabel(label_, tip,
            significant(grasp->forces.pull.norm()) + " N, squeezing " + significant(grasp->forces.squeeze) + " N" +
                (idle.empty() ? "" : "    " + idle),
            kForce);
}

}  // namespace pointbased
