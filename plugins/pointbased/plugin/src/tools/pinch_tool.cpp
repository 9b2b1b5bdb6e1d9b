// SPDX-License-Identifier: Apache-2.0
#include "tools/pinch_tool.h"

#include <algorithm>
#include <utility>

#include "base/number_text.h"

namespace pointbased {
namespace {

constexpr double kMarkerRadius = 0.3;  // of the spacing

}  // namespace

PinchTool::PinchTool(const Services &services, std::shared_ptr<InteractionSteps> steps)
    : InteractiveTool(services, std::move(steps)) {}

bool PinchTool::onEvent(const c3de_event &event) {
  if (event.type == C3DE_EVENT_PRESS && event.button == C3DE_BUTTON_LEFT) return press(event);
  const bool isLeftRelease = event.type == C3DE_EVENT_RELEASE && event.button == C3DE_BUTTON_LEFT;
  if (!hold_) {
    if (isLeftRelease) label_.reset();  // of a refusal
    return false;
  }
  if (event.type == C3DE_EVENT_MOVE) {
    if (hold_->isRestored) return false;
    drag(event);
    return true;
  }
  if ((isLeftRelease && !hold_->isRestored) || (event.type == C3DE_EVENT_KEY && event.key == 27)) {
    release();
    return true;
  }
  return false;
}

bool PinchTool::press(const c3de_event &event) {
  if (!simulator_ || (hold_ && !hold_->isRestored)) return false;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  release();
  refusal_.clear();
  if (sdk::isInSlice(event)) {
    const BodySnapshot *body = bodyAt(*snapshot, ray->origin);
    if (!body || !warnIfQuasiStatic(*snapshot, "Pinch", "a hand could pull")) pressInside(body, ray->origin);
    return true;
  }
  if (const std::optional<double> slice = sdk::seenInside(event)) {
    c3de_event there = event;
    for (std::size_t i = 0; i < 3; ++i) there.ray_origin_mm[i] += *slice * event.ray_direction[i];
    const Vec3 position = rayOf(services_, simulator_->node(), there).value_or(*ray).origin;
    if (const BodySnapshot *body = bodyAt(*snapshot, position)) {
      if (!warnIfQuasiStatic(*snapshot, "Pinch", "a hand could pull")) pressInside(body, position);
      return true;
    }
  }
  return pressSurface(*snapshot, *ray);
}

bool PinchTool::pressSurface(const Snapshot &snapshot, const PickRay &ray) {
  const std::optional<PickedSurface> picked = pick(services_, snapshot, ray);
  // An organ behind another object cannot be reached.
  if (!picked || !picked->body) return false;
  if (warnIfQuasiStatic(snapshot, "Pinch", "a hand could pull")) return true;
  const BodySnapshot &body = *picked->body;
  const Vec3 &pressedPoint = picked->at;
  if (body.isStatic) {
    showRefusal(pressedPoint, body.name + " is rigid and fixed");
    return true;
  }
  const auto &corners = body.surface->triangles[picked->triangle];
  const std::uint32_t surfel = *std::min_element(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
    return (vectorOf(body.surfels[a]) - pressedPoint).squaredNorm() <
           (vectorOf(body.surfels[b]) - pressedPoint).squaredNorm();
  });
  begin(body, grabAround(*body.rest, surfel, tissueSettings(), body.youngsModulus), surfel, pressedPoint);
  return true;
}

void PinchTool::pressInside(const BodySnapshot *body, const Vec3 &position) {
  if (!body) return showRefusal(position, "No body here");
  if (body->isStatic) return showRefusal(position, body->name + " is rigid and fixed");
  const std::optional<MaterialPoint> material = materialAt(*body->rest, body->phyxels, position);
  if (!material) return showRefusal(position, body->name + " has nothing to hold");
  Grab grab = grabAt(*body->rest, material->at, tissueSettings(), body->youngsModulus);
  if (material->isHeld || grab.phyxels.empty()) return showRefusal(position, body->name + " is held by a fix there");
  begin(*body, std::move(grab), std::nullopt, position);
  const std::size_t part = materialNumberAt(*body->rest, material->at);
  if (part > 0 && body->tissues && part <= body->tissues->size() && !(*body->tissues)[part - 1].empty())
    hold_->what += ": " + (*body->tissues)[part - 1];
}

// Null if there is none. Where bodies overlap, the one whose material is shown in slices.
const BodySnapshot *PinchTool::bodyAt(const Snapshot &snapshot, const Vec3 &position) const {
  const std::vector<const BodySnapshot *> all = Skins(services_, snapshot).bodiesAt(position);
  if (all.size() < 2) return all.empty() ? nullptr : all.front();
  simulator_->abandonLongStep();
  const Vec3 shown = position - simulator_->parts().queries.displacementAt(position);
  const auto distance = [&](const BodySnapshot *body) {
    const auto material = materialAt(*body->rest, body->phyxels, position);
    return material ? (body->rest->origin + material->at - shown).norm() : (position - shown).norm();
  };
  return *std::min_element(all.begin(), all.end(),
                           [&](const auto *a, const auto *b) { return distance(a) < distance(b); });
}

// The user's own limit applies in addition to that of the tissue, which is computed on its body.
PinchSettings PinchTool::tissueSettings() const {
  PinchSettings settings = settings_;
  settings.largestForce = 0.0;
  return settings;
}

void PinchTool::begin(const BodySnapshot &body, Grab grab, std::optional<std::size_t> surfel,
                      const Vec3 &pressedPoint) {
  grab.target.setZero();
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) grab.target += grab.weights[k] * body.phyxels[grab.phyxels[k]];
  planePoint_ = pressedPoint;
  grabOffset_ = grab.target - pressedPoint;
  hold_ = Hold{body.id,      body.name, surfel, surfel ? vectorOf(body.surfels[*surfel]) : pressedPoint,
               pressedPoint, 0.0,       0.0,    idleReason()};
  history_.begin(simulator_);
  simulator_->liftStepBudget();
  change([id = body.id, grab = std::move(grab), own = settings_.largestForce](const BodyQueries &queries) {
    return BeginPinch{queries.nameOfBody(id), grab, own};
  });
  showMarker(body);
}

void PinchTool::showRefusal(const Vec3 &position, const std::string &why) {
  refusal_ = why;
  if (services_.render) showLabel(label_, position, why, kForce);
}

void PinchTool::updateHold(const BodySnapshot &body) {
  hold_->idleReason = idleReason();
  hold_->force = body.grab ? body.grab->force.norm() : 0.0;
  hold_->mass = body.grab ? body.grab->mass : 0.0;
  if (hold_->surfel)
    hold_->point = vectorOf(body.surfels[*hold_->surfel]);
  else if (hold_->mass > 0.0)  // a step has been made with it; an interior point moves with the patch around it
    hold_->point = body.grab->point - grabOffset_;
}

// The target moves in the plane through the pressed point, parallel to the screen; in a slice, in the displayed plane.
void PinchTool::drag(const c3de_event &event) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!ray) return;
  const std::optional<Vec3> at = sdk::isInSlice(event) ? ray->origin : ray->onScreenPlane(planePoint_);
  if (!at) return;
  hold_->target = *at;
  change([id = hold_->body, target = Vec3(hold_->target + grabOffset_)](const BodyQueries &queries) {
    return MovePinch{queries.nameOfBody(id), target};
  });
}

void PinchTool::release() {
  if (!hold_) return;
  if (simulator_) simulator_->abandonLongStep();
  change([id = hold_->body](const BodyQueries &queries) { return ReleasePinch{queries.nameOfBody(id)}; });
  if (!hold_->isRestored) history_.end("pull on " + hold_->what);
  releasing_ = hold_->body;
  hold_.reset();
  hideMarker();
}

void PinchTool::showRestored(const Snapshot &snapshot) {
  if (const BodySnapshot *body = snapshot.body(releasing_); !body || !body->grab) releasing_ = 0;
  const auto held = std::find_if(snapshot.bodies.begin(), snapshot.bodies.end(), [this](const BodySnapshot &body) {
    return body.grab.has_value() && body.id != releasing_;
  });
  if (held == snapshot.bodies.end()) return;
  const Vec3 &at = held->grab->point;
  hold_ = Hold{held->id, held->name, std::nullopt, at, at, 0.0, 0.0, {}, true};
  grabOffset_.setZero();
}

void PinchTool::cancel() {
  release();
  label_.reset();
}

void PinchTool::showMarker(const BodySnapshot &body) {
  if (!services_.render) return;
  if (marker_)
    (void)services_.render.update(marker_.handle(), C3DE_ATTR_POSITIONS, viewOf({&hold_->point, 1}));
  else if (auto made = services_.render.createSpheres(simulator_->node(), viewOf({&hold_->point, 1}),
                                                      kMarkerRadius * body.rest->spacing, kForce))
    marker_ = std::move(*made);
  showArrow(arrow_, hold_->point, hold_->target - hold_->point);
  const std::string force = fixed(hold_->force, 2) + " N";
  const std::string idle = hold_->isRestored ? "Esc releases it" : hold_->idleReason;
  showLabel(label_, hold_->target, idle.empty() ? force : hold_->force == 0.0 ? idle : force + "    " + idle, kForce);
}

void PinchTool::hideMarker() {
  marker_.reset();
  arrow_.reset();
  label_.reset();
}

void PinchTool::update() {
  history_.update();
  if (!simulator_) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  if (!hold_ && snapshot) showRestored(*snapshot);
  if (!hold_) return;
  const BodySnapshot *body = snapshot ? snapshot->body(hold_->body) : nullptr;
  if (hold_->isRestored && body && !body->grab) {  // released by a reset or by undo
    hold_.reset();
    hideMarker();
    return;
  }
  if (!body || (hold_->surfel && *hold_->surfel >= body->surfels.size())) {
    release();
    return;
  }
  updateHold(*body);
  showMarker(*body);
}

}  // namespace pointbased
