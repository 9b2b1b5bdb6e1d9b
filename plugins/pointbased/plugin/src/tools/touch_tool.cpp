// SPDX-License-Identifier: Apache-2.0
#include "tools/touch_tool.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "instruments/clear_position.h"

namespace pointbased {
namespace {

constexpr sdk::Material kTargetLine{{0.9f, 0.9f, 0.9f, 1.0f}, false, true};
constexpr sdk::Material kPreview{{0.45f, 0.75f, 0.95f, 0.45f}, true, true};
constexpr double kMetresPerNotch = 1e-3;  // m, per notch of the wheel or key press
constexpr double kGap = 1e-4;             // m, initial distance between the instrument and the surface
constexpr double kTargetDistance = 1e-3;  // m: the target differs from the present position

PlaceInstrument instrumentOf(const InstrumentSettings &settings, const Vec3 &middle, const Vec3 &axis) {
  return {kMetresPerMillimetre * settings.radius_mm, kMetresPerMillimetre * settings.length_mm, settings.friction,
          middle, axis};
}

bool isWithin(const ObstacleSnapshot &instrument, const Vec3 &position) {
  const ProbeTool &tool = *instrument.tool;
  const Vec3 axis = instrument.motion.rotation * tool.path.front().axis.normalized(),
             offset = position - instrument.middle();
  const double along = std::clamp(offset.dot(axis), -0.5 * tool.length, 0.5 * tool.length);
  return (offset - along * axis).norm() <= tool.radius;
}

}  // namespace

TouchTool::TouchTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
    : InteractiveTool(services, std::move(steps)) {}

void TouchTool::setSettings(const InstrumentSettings &settings) {
  if (settings == settings_) return;
  settings_ = settings;
  isChosen_ = true;
  if (target_) placeInstrument(*target_, axis_);
}

bool TouchTool::onEvent(const c3de_event &event) {
  switch (event.type) {
    case C3DE_EVENT_PRESS: return event.button == C3DE_BUTTON_LEFT && press(event);
    case C3DE_EVENT_MOVE:
      if (drag_) drag(event);
      hovered_ = event;
      return drag_.has_value();
    case C3DE_EVENT_WHEEL:
      if (!drag_ || sdk::isInSlice(event))
        return false;  // the wheel changes the slice, and the instrument moves with
                       // it
      pushAlongView(event, kMetresPerNotch * event.wheel);
      return true;
    case C3DE_EVENT_RELEASE:
      if (!drag_ || event.button != C3DE_BUTTON_LEFT) return false;
      release();
      return true;
    case C3DE_EVENT_KEY:
      if (!target_) return false;
      if (event.key == 'D' || event.key == 'B') {
        pushAlongView(event, event.key == 'D' ? kMetresPerNotch : -kMetresPerNotch);
        return true;
      }
      if (event.key == 'X') {
        removeInstrument();
        return true;
      }
      return false;
    default: return false;
  }
}

bool TouchTool::press(const c3de_event &event) {
  if (!simulator_ || drag_) return false;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  const bool isSlice = sdk::isInSlice(event);
  const std::optional<PickedSurface> picked = isSlice ? std::nullopt : pick(services_, *snapshot, *ray);
  if (!isSlice && !picked) return false;
  if (warnIfQuasiStatic(*snapshot, "Touch", "an instrument could push",
                        "; a [[probe_tool]] of the scene moves with the load factor"))
    return true;
  hovered_.reset();
  preview_.reset();
  const Vec3 pressedPoint = picked ? picked->at : ray->origin;
  const ObstacleSnapshot *instrument = snapshot->instrument();
  if (isSlice ? instrument && isWithin(*instrument, pressedPoint)
              : picked->obstacle && picked->obstacle->isInstrument) {
    history_.begin(simulator_);
    drag_ = Drag{pressedPoint, instrument->middle() - pressedPoint};
    return true;
  }
  const std::optional<InstrumentPose> pose = picked ? onSurface(*picked, *ray) : inSlice(*snapshot, *ray);
  if (!pose) {
    (void)services_.notifier.notify(C3DE_LOG_INFO, "Touch",
                                    "The skin is close on both sides of this slice; press where the slice crosses it");
    return true;
  }
  history_.begin(simulator_);
  settings_.radius_mm = pose->radius_mm;
  drag_ = Drag{pressedPoint, pose->middle - pressedPoint};
  forces_.clear();
  placeInstrument(pose->middle, pose->axis);
  return true;
}

// It touches with its sphere, or with the end of its capsule; the other end points towards the eye.
TouchTool::InstrumentPose TouchTool::onSurface(const PickedSurface &picked, const PickRay &ray) const {
  InstrumentPose pose{Vec3::Zero(), -ray.direction, radiusOn(picked.body)};
  pose.middle = picked.at + (kMetresPerMillimetre * pose.radius_mm + kGap) * picked.normal + halfAxis(pose.axis);
  return pose;
}

// Next to the nearest skin; a capsule points away from it.
std::optional<TouchTool::InstrumentPose> TouchTool::inSlice(const Snapshot &snapshot, const PickRay &ray) const {
  const Vec3 &position = ray.origin, &normal = ray.view;
  const Skins skins(services_, snapshot);
  const NearSkin nearest = skins.nearestSkin(position);
  InstrumentPose pose{position, normal.unitOrthogonal(), radiusOn(nearest.body)};
  const double radius = kMetresPerMillimetre * pose.radius_mm + kGap;
  const std::optional<Vec3> end = clearPosition(position, normal, radius, [&](const Vec3 &at) {
    const NearSkin skin = skins.nearestSkin(at);
    return SkinDistance{skin.body ? skin.distance : radius, skin.outwards};
  });
  if (!end) return std::nullopt;
  const Vec3 away = nearest.outwards - nearest.outwards.dot(normal) * normal;
  if (away.norm() > 0.1) pose.axis = away.normalized();
  pose.middle = *end + halfAxis(pose.axis);
  return pose;
}

Vec3 TouchTool::halfAxis(const Vec3 &axis) const { return 0.5 * kMetresPerMillimetre * settings_.length_mm * axis; }

// Not set by the user: a thinner instrument would sink in between the contact points.
double TouchTool::radiusOn(const BodySnapshot *body) const {
  if (!body || isChosen_) return settings_.radius_mm;
  return std::max(settings_.radius_mm, std::ceil(body->rest->spacing / kMetresPerMillimetre));
}

void TouchTool::placeInstrument(const Vec3 &middle, const Vec3 &axis) {
  target_ = middle;
  axis_ = axis;
  isPending_ = true;
  simulator_->abandonLongStep();
  change([tool = instrumentOf(settings_, middle, axis)](const BodyQueries &) { return tool; });
}

void TouchTool::moveTo(const Vec3 &middle) {
  if (!target_) return;
  target_ = middle;
  change([middle](const BodyQueries &) { return MoveInstrument{middle}; });
}

void TouchTool::drag(const c3de_event &event) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray) return;
  const std::optional<Vec3> at = sdk::isInSlice(event) ? ray->origin : ray->onScreenPlane(drag_->point);
  if (at) moveTo(*at + drag_->offset);
}

void TouchTool::pushAlongView(const c3de_event &event, double distance_m) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray || !target_) return;
  const Vec3 along = distance_m * ray->view;
  if (drag_) (sdk::isInSlice(event) ? drag_->offset : drag_->point) += along;
  moveTo(*target_ + along);
}

void TouchTool::release() {
  if (!drag_) return;
  drag_.reset();
  history_.end("touch");
}

void TouchTool::cancel() {
  release();
  hovered_.reset();
  preview_.reset();
}

void TouchTool::removeInstrument() {
  if (simulator_) simulator_->abandonLongStep();
  change([](const BodyQueries &) { return RemoveInstrument(); });
  clear();
}

void TouchTool::clear() {
  release();
  target_.reset();
  isPending_ = false;
  hovered_.reset();
  for (sdk::Proxy *proxy : {&preview_, &arrow_, &targetLine_, &label_}) proxy->reset();
}

// Shows where the instrument would be placed.
void TouchTool::showPreview() {
  if (!hovered_) return;
  const c3de_event event = *hovered_;
  hovered_.reset();
  preview_.reset();
  if (drag_ || !isActive() || !services_.render) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return;
  std::optional<InstrumentPose> pose;
  if (sdk::isInSlice(event)) {
    if (const ObstacleSnapshot *instrument = snapshot->instrument(); instrument && isWithin(*instrument, ray->origin))
      return;
    pose = inSlice(*snapshot, *ray);
  } else if (const auto picked = pick(services_, *snapshot, *ray);
             picked && !(picked->obstacle && picked->obstacle->isInstrument)) {
    pose = onSurface(*picked, *ray);
  }
  if (!pose) return;
  const Vec3 end = pose->middle - halfAxis(pose->axis);  // the touching end
  if (auto made = services_.render.createSpheres(simulator_->node(), viewOf(std::span(&end, 1)),
                                                 kMetresPerMillimetre * pose->radius_mm, kPreview))
    preview_ = std::move(*made);
}

void TouchTool::showForce(const ObstacleSnapshot &instrument) {
  if (!services_.render) return;
  const Vec3 middle = instrument.middle(), &force = instrument.touch.force;
  const Vec3 tip = showArrow(arrow_, middle, force, forces_.largest());
  // The target is ahead while it moves faster than the simulation, or while the simulation does not run.
  if ((*target_ - middle).norm() > kTargetDistance)
    showLines(targetLine_, std::array<Vec3, 2>{middle, *target_}, kTargetLine);
  else
    targetLine_.reset();
  const std::string idle = drag_ ? idleReason() : std::string();
  showLabel(label_, tip, significant(force.norm()) + " N" + (idle.empty() ? "" : "    " + idle), kForce);
}

void TouchTool::update() {
  history_.update();
  if (!simulator_) return;
  showPreview();
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const ObstacleSnapshot *instrument = snapshot ? snapshot->instrument() : nullptr;
  if (!instrument) {
    // Removed by a reset or by undo.
    if (target_ && !isPending_) clear();
    return;
  }
  isPending_ = false;
  if (!target_) {  // restored by undo
    target_ = instrument->middle();
    axis_ = instrument->motion.rotation * instrument->tool->path.front().axis;
  }
  forces_.addSample(instrument->touch.force.norm(), snapshot->time);
  showForce(*instrument);
}

}  // namespace pointbased
