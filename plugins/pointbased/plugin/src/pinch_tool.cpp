// SPDX-License-Identifier: Apache-2.0
#include "pinch_tool.h"

#include <algorithm>

#include "number_text.h"

namespace pointbased {
namespace {

constexpr sdk::Material kMarker{{1.0f, 0.85f, 0.2f, 1.0f}, false};
constexpr double kMarkerRadius = 0.3;  // of the spacing
}  // namespace

PinchTool::PinchTool(const Services &services) : HandTool(services) {}

bool PinchTool::onEvent(const c3de_event &event) {
  if (event.type == C3DE_EVENT_PRESS && event.button == C3DE_BUTTON_LEFT) return press(event);
  if (!hold_) return false;
  if (event.type == C3DE_EVENT_MOVE) {
    drag(event);
    return true;
  }
  if (event.type == C3DE_EVENT_RELEASE && event.button == C3DE_BUTTON_LEFT) {
    release();
    return true;
  }
  if (event.type == C3DE_EVENT_KEY && event.key == 27) {
    release();
    return true;
  }
  return false;
}

bool PinchTool::press(const c3de_event &event) {
  if (!simulator_ || hold_) return false;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  if (!snapshot || !ray) return false;
  const std::optional<PickedSurface> picked = pick(services_, *snapshot, *ray);
  // What stands in front of the organ cannot be reached through.
  if (!picked || !picked->body) return false;
  const BodySnapshot *body = picked->body;
  const Vec3 &under = picked->at;
  const auto &corners = body->surface->triangles[picked->triangle];
  const std::uint32_t surfel = *std::min_element(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
    return (vectorOf(body->surfels[a]) - under).squaredNorm() < (vectorOf(body->surfels[b]) - under).squaredNorm();
  });

  Grab grab = grabAround(*body->rest, surfel, settings_, body->youngsModulus);
  Vec3 grabbed = Vec3::Zero();
  for (std::size_t k = 0; k < grab.phyxels.size(); ++k) grabbed += grab.weights[k] * body->phyxels[grab.phyxels[k]];
  grab.target = grabbed;

  planePoint_ = under;
  grabOffset_ = grabbed - under;
  hold_ = Hold{body->id, body->name, surfel, vectorOf(body->surfels[surfel]), under, 0.0, 0.0};
  history_.begin(simulator_);
  post([id = body->id, grab](WorldSimulator &s) { s.setGrab(id, grab); });
  showMarker();
  return true;
}

// The hand moves in the plane through the point that was pressed, parallel to the screen.
void PinchTool::drag(const c3de_event &event) {
  const std::optional<PickRay> ray = rayOf(services_, simulator_->node(), event);
  const std::optional<Vec3> at = ray ? ray->onScreenPlane(planePoint_) : std::nullopt;
  if (!at) return;
  hold_->target = *at;
  post([id = hold_->body, target = Vec3(hold_->target + grabOffset_)](WorldSimulator &s) { s.moveGrab(id, target); });
}

void PinchTool::release() {
  if (!hold_) return;
  if (simulator_) simulator_->abandonLongStep();
  post([id = hold_->body](WorldSimulator &s) { s.releaseGrab(id); });
  history_.end("pull on " + hold_->bodyName);
  hold_.reset();
  hideMarker();
}

void PinchTool::cancel() { release(); }

void PinchTool::showMarker() {
  if (!services_.render || !simulator_) return;
  const BodySnapshot *body = nullptr;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  if (snapshot) body = snapshot->body(hold_->body);
  if (!body) return;
  const c3de_handle node = simulator_->node();
  const std::array<Vec3, 2> points{hold_->surfelPosition, hold_->target};
  if (auto made = services_.render.createSpheres(node, viewOf({points.data(), 1}), kMarkerRadius * body->rest->spacing,
                                                 kMarker))
    marker_ = std::move(*made);
  if (auto made = services_.render.createLines(node, viewOf(points), 3.0f, kMarker)) line_ = std::move(*made);
  if (auto made = services_.render.createLabel(node, toArray(hold_->target), fixed(0.0, 2) + " N", kMarker))
    label_ = std::move(*made);
}

void PinchTool::hideMarker() {
  marker_.reset();
  line_.reset();
  label_.reset();
}

void PinchTool::update() {
  history_.update();
  if (!hold_ || !simulator_) return;
  const std::shared_ptr<const Snapshot> snapshot = simulator_->snapshot();
  const BodySnapshot *body = snapshot ? snapshot->body(hold_->body) : nullptr;
  if (!body || hold_->surfel >= body->surfels.size()) {
    release();
    return;
  }
  hold_->surfelPosition = vectorOf(body->surfels[hold_->surfel]);
  hold_->force = body->grab ? body->grab->force.norm() : 0.0;
  hold_->mass = body->grab ? body->grab->mass : 0.0;
  if (!marker_) return;
  const std::array<Vec3, 2> points{hold_->surfelPosition, hold_->target};
  (void)services_.render.update(marker_.handle(), C3DE_ATTR_POSITIONS, viewOf({points.data(), 1}));
  (void)services_.render.update(line_.handle(), C3DE_ATTR_POSITIONS, viewOf(points));
  (void)services_.render.setLabel(label_.handle(), toArray(hold_->target), fixed(hold_->force, 2) + " N");
}

}  // namespace pointbased
