// SPDX-License-Identifier: Apache-2.0
#include "pinch_tool.h"

#include <cstdio>

namespace mass_spring {
namespace {

constexpr sdk::Material kHand{{1.0f, 0.85f, 0.2f, 1.0f}, false};
constexpr double kSpacings = 2.0;  // radius of what is held
constexpr int kEscape = 27;

}  // namespace

void PinchTool::setSimulator(Simulator *simulator) {
  if (simulator_.get() == simulator) return;
  release();
  simulator_ = sdk::Ref<Simulator>::share(simulator);
}

void PinchTool::post(std::function<void(Simulator &)> command) const {
  if (!simulator_) return;
  sdk::orThrow(simulation_.post(simulator_->node(),
                                [simulator = simulator_, command = std::move(command)] { command(*simulator); }));
}

/// The node's frame differs from the world by a rotation, one scale and a displacement.
std::optional<PinchTool::Ray> PinchTool::rayOf(const c3de_event &event) const {
  const auto matrix = scene_.worldFromNode(simulator_->node());
  if (!matrix) return std::nullopt;
  const double *m = matrix->data();
  const std::array<Vec3, 3> axes{vectorOf(m), vectorOf(m + 4), vectorOf(m + 8)};
  const double squared = dot(axes[0], axes[0]);
  const Vec3 from = vectorOf(event.ray_origin_mm) - vectorOf(m + 12), along = vectorOf(event.ray_direction);
  Ray ray;
  for (std::size_t a = 0; a < 3; ++a) {
    ray.origin[a] = dot(axes[a], from) / squared;
    ray.direction[a] = dot(axes[a], along) / std::sqrt(squared);
  }
  return ray;
}

bool PinchTool::onEvent(const c3de_event &event) {
  if (event.type == C3DE_EVENT_PRESS && event.button == C3DE_BUTTON_LEFT) return press(event);
  if (!body_) return false;
  if (event.type == C3DE_EVENT_MOVE)
    drag(event);
  else if ((event.type == C3DE_EVENT_RELEASE && event.button == C3DE_BUTTON_LEFT) ||
           (event.type == C3DE_EVENT_KEY && event.key == kEscape))
    release();
  else
    return false;
  return true;
}

bool PinchTool::press(const c3de_event &event) {
  if (!simulator_ || body_) return false;
  const auto snapshot = simulator_->snapshot();
  const auto ray = rayOf(event);
  if (!snapshot || !ray) return false;
  const Snapshot::Body *body = nullptr;
  c3de_ray_hit nearest{};
  for (const Snapshot::Body &candidate : snapshot->bodies) {
    const auto tree =
        collision_.create(sdk::rows<double, 3>(candidate.skin), sdk::rows<std::uint32_t, 3>(*candidate.triangles));
    if (!tree) continue;
    const auto hit = collision_.ray(tree->handle(), ray->origin, ray->direction);
    if (!hit || hit->triangle >= candidate.triangles->size() || (body != nullptr && hit->t >= nearest.t)) continue;
    body = &candidate;
    nearest = *hit;
  }
  if (body == nullptr) return false;
  body_ = body->id;
  under_ = (*body->triangles)[nearest.triangle];
  target_ = ray->origin + nearest.t * ray->direction;
  // The hand moves in the plane through the point that was pressed, parallel to the screen.
  viewDirection_ = vectorOf(event.view_direction);
  // Named and used by the simulation's thread alone.
  hold_ = std::make_shared<c3de_handle>();
  post([id = *body_, at = target_, radius = kSpacings * body->spacing_m, hold = hold_](Simulator &s) {
    c3de_sim_hold asked{};
    asked.size = sizeof asked;
    std::copy(at.begin(), at.end(), asked.at_m);
    asked.radius_m = radius;
    s.hold({id}, &asked, hold.get());
  });
  const std::array<Vec3, 2> ends{target_, target_};
  line_ = sdk::orThrow(render_.createLines(simulator_->node(), sdk::rows<double, 3>(ends), 3.0f, kHand));
  label_ = sdk::orThrow(render_.createLabel(simulator_->node(), target_, "0.00 N", kHand));
  return true;
}

void PinchTool::drag(const c3de_event &event) {
  const auto ray = rayOf(event);
  if (!ray) return;
  const double along = dot(ray->direction, viewDirection_);
  if (std::abs(along) < 1e-9) return;
  const double t = dot(target_ - ray->origin, viewDirection_) / along;
  if (t <= 0.0) return;
  target_ = ray->origin + t * ray->direction;
  // A body that has gone meanwhile is pulled by nobody.
  post([hold = hold_, target = target_](Simulator &s) { s.pull(*hold, target.data(), nullptr); });
}

void PinchTool::release() {
  if (!body_) return;
  post([hold = hold_](Simulator &s) { s.remove(*hold); });
  body_.reset();
  line_.reset();
  label_.reset();
}

void PinchTool::update() {
  if (!body_ || !simulator_) return;
  const auto snapshot = simulator_->snapshot();
  if (!snapshot) return;
  const auto body = std::find_if(snapshot->bodies.begin(), snapshot->bodies.end(),
                                 [&](const Snapshot::Body &b) { return b.id == *body_; });
  if (body == snapshot->bodies.end()) {
    body_.reset();
    line_.reset();
    label_.reset();
    return;
  }
  const Vec3 held = (1.0 / 3.0) * (body->skin[under_[0]] + body->skin[under_[1]] + body->skin[under_[2]]);
  const std::array<Vec3, 2> ends{held, target_};
  char text[32];
  std::snprintf(text, sizeof text, "%.2f N", body->handForce_N ? length(*body->handForce_N) : 0.0);
  sdk::orThrow(render_.update(line_.handle(), C3DE_ATTR_POSITIONS, sdk::rows<double, 3>(ends)));
  sdk::orThrow(render_.setLabel(label_.handle(), target_, text));
}

}  // namespace mass_spring
