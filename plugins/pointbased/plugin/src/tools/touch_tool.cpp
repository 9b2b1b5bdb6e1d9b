// SPDX-License-Identifier: Apache-2.0
#include "tools/touch_tool.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "instruments/clear_position.h"

namespace pointbased {
namespace {

constexpr sdk::Material kHand{{0.9f, 0.9f, 0.9f, 1.0f}, false, true};
constexpr sdk::Material kGhost{{0.45f, 0.75f, 0.95f, 0.45f}, true, true};
constexpr double kPerNotch = 1e-3;  // m, per notch of the wheel or key press
constexpr double kGap = 1e-4;       // m, initial distance between the instrument and the surface
constexpr double kAway = 1e-3;      // m: the target differs from the present position

ProbeTool instrumentOf(const InstrumentSettings &settings, const Vec3 &middle, const Vec3 &axis) {
  ProbeTool tool;
  tool.radius = kMetresPerMillimetre * settings.radius_mm;
  tool.length = kMetresPerMillimetre * settings.length_mm;
  tool.friction = settings.friction;
  tool.path = {{0.0, middle, axis}};
  return tool;
}

bool isWithin(const ObstacleSnapshot &instrument, const Vec3 &place) {
  const ProbeTool &tool = *instrument.tool;
  const Vec3 axis = instrument.motion.rotation * tool.path.front().axis.normalized(), way = place - instrument.middle();
  const double along = std::clamp(way.dot(axis), -0.5 * tool.length, 0.5 * tool.length);
  return (way - along * axis).norm() <= tool.radius;
}

}  // namespace

TouchTool::TouchTool(const Services &services) : InteractiveTool(services) {}

void TouchTool::setSettings(const InstrumentSettings &settings) {
  if (settings == settings_) return;
  settings_ = settings;
  isChosen_ = true;
  if (target_) place(*target_, axis_);
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
      pushAlongView(event, kPerNotch * event.wheel);
      return true;
    case C3DE_EVENT_RELEASE:
      if (!drag_ || event.button != C3DE_BUTTON_LEFT) return false;
      release();
      return true;
    case C3DE_EVENT_KEY:
      if (!target_) return false;
      if (event.key == 'D' || event.key == 'B') {
        pushAlongView(event, event.key == 'D' ? kPerNotch : -kPerNotch);
        return true;
      }
      if (event.key == 'X') {
        takeAway();
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
  ghost_.reset();
  const Vec3 under = picked ? picked->at : ray->origin;
  const ObstacleSnapshot *instrument = snapshot->instrument();
  if (isSlice ? instrument && isWithin(*instrument, under) : picked->obstacle && picked->obstacle->isInstrument) {
    history_.begin(simulator_);
    drag_ = Drag{under, instrument->middle() - under};
    return true;
  }
  const std::optional<Placing> placing = picked ? onSurface(*picked, *ray) : inSlice(*snapshot, *ray);
  if (!placing) {
    (void)services_.notifier.notify(C3DE_LOG_INFO, "Touch",
                                    "The skin is close on both sides of this slice; press where the slice crosses it");
    return true;
  }
  history_.begin(simulator_);
  settings_.radius_mm = placing->radius_mm;
  drag_ = Drag{under, placing->middle - under};
  forces_.clear();
  place(placing->middle, placing->axis);
  return true;
}

// It touches with its sphere, or with the end of its capsule; the other end points towards the eye.
TouchTool::Placing TouchTool::onSurface(const PickedSurface &picked, const PickRay &ray) const {
  Placing placing{Vec3::Zero(), -ray.direction, radiusOn(picked.body)};
  placing.middle = picked.at + (kMetresPerMillimetre * placing.radius_mm + kGap) * picked.normal + halfOf(placing.axis);
  return placing;
}

// Next to the nearest skin; a capsule points away from it.
std::optional<TouchTool::Placing> TouchTool::inSlice(const Snapshot &snapshot, const PickRay &ray) const {
  const Vec3 &place = ray.origin, &normal = ray.view;
  const Skins skins(services_, snapshot);
  const NearSkin near = skins.near(place);
  Placing placing{place, normal.unitOrthogonal(), radiusOn(near.body)};
  const double radius = kMetresPerMillimetre * placing.radius_mm + kGap;
  const std::optional<Vec3> end = clearPosition(place, normal, radius, [&](const Vec3 &at) {
    const NearSkin skin = skins.near(at);
    return SkinDistance{skin.body ? skin.distance : radius, skin.outwards};
  });
  if (!end) return std::nullopt;
  const Vec3 away = near.outwards - near.outwards.dot(normal) * normal;
  if (away.norm() > 0.1) placing.axis = away.normalized();
  placing.middle = *end + halfOf(placing.axis);
  return placing;
}

Vec3 TouchTool::halfOf(const Vec3 &axis) const { return 0.5 * kMetresPerMillimetre * settings_.length_mm * axis; }

// Not set by the user: a thinner instrument would sink in between the contact points.
double TouchTool::radiusOn(const BodySnapshot *body) const {
  if (!body || isChosen_) return settings_.radius_mm;
  return std::max(settings_.radius_mm, std::ceil(body->rest->spacing / kMetresPerMillimetre));
}

void TouchTool::place(const Vec3 &middle, const Vec3 &axis) {
  target_ = middle;
  axis_ = axis;
  isAwaited_ = true;
  simulator_->abandonLongStep();
  post(
      [tool = instrumentOf(settings_, middle, axis)](WorldSimulator &s) { s.parts().obstacles.placeInstrument(tool); });
}

void TouchTool::moveTo(const Vec3 &middle) {
  if (!target_) return;
  target_ = middle;
  post([middle](WorldSimulator &s) { s.parts().obstacles.moveInstrument(middle); });
}

void TouchTool::drag(const c3de_event &event) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray) return;
  const std::optional<Vec3> at = sdk::isInSlice(event) ? ray->origin : ray->onScreenPlane(drag_->point);
  if (at) moveTo(*at + drag_->offset);
}

void TouchTool::pushAlongView(const c3de_event &event, double way) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray || !target_) return;
  const Vec3 along = way * ray->view;
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
  ghost_.reset();
}

void TouchTool::takeAway() {
  if (simulator_) simulator_->abandonLongStep();
  post([](WorldSimulator &s) { s.parts().obstacles.removeInstrument(); });
  forget();
}

void TouchTool::forget() {
  release();
  target_.reset();
  isAwaited_ = false;
  hovered_.reset();
  for (sdk::Proxy *proxy : {&ghost_, &arrow_, &hand_, &label_}) proxy->reset();
}

// Shows where the instrument would be placed.
void TouchTool::hover() {
  if (!hovered_) return;
  const c3de_event event = *hovered_;
  hovered_.reset();
  ghost_.reset();
  if (drag_ || !isActive() || !services_.render) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return;
  std::optional<Placing> placing;
  if (sdk::isInSlice(event)) {
    if (const ObstacleSnapshot *instrument = snapshot->instrument(); instrument && isWithin(*instrument, ray->origin))
      return;
    placing = inSlice(*snapshot, *ray);
  } else if (const auto picked = pick(services_, *snapshot, *ray);
             picked && !(picked->obstacle && picked->obstacle->isInstrument)) {
    placing = onSurface(*picked, *ray);
  }
  if (!placing) return;
  const Vec3 end = placing->middle - halfOf(placing->axis);  // the touching end
  if (auto made = services_.render.createSpheres(simulator_->node(), viewOf(std::span(&end, 1)),
                                                 kMetresPerMillimetre * placing->radius_mm, kGhost))
    ghost_ = std::move(*made);
}

void TouchTool::showForce(const ObstacleSnapshot &instrument) {
  if (!services_.render) return;
  const Vec3 middle = instrument.middle(), &force = instrument.touch.force;
  const Vec3 tip = showArrow(arrow_, middle, force, forces_.largest());
  // The target is ahead while it moves faster than the simulation, or while the simulation does not run.
  if ((*target_ - middle).norm() > kAway)
    showLines(hand_, std::array<Vec3, 2>{middle, *target_}, kHand);
  else
    hand_.reset();
  const std::string still = drag_ ? idleReason() : std::string();
  showLabel(label_, tip, significant(force.norm()) + " N" + (still.empty() ? "" : "    " + still), kForce);
}

void TouchTool::update() {
  history_.update();
  if (!simulator_) return;
  hover();
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const ObstacleSnapshot *instrument = snapshot ? snapshot->instrument() : nullptr;
  if (!instrument) {
    // Removed by a reset or by undo.
    if (target_ && !isAwaited_) forget();
    return;
  }
  isAwaited_ = false;
  if (!target_) {  // restored by undo
    target_ = instrument->middle();
    axis_ = instrument->motion.rotation * instrument->tool->path.front().axis;
  }
  forces_.take(instrument->touch.force.norm(), snapshot->time);
  showForce(*instrument);
}

}  // namespace pointbased
