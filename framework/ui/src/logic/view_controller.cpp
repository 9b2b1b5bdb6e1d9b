// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/view_controller.h"

#include <algorithm>
#include <numbers>

#include "logic/tool_event.h"

namespace c3de::ui {
namespace {

constexpr double kPixelsPerZoomStep = 20.0;
constexpr double kNeverWithin_mm = 1e9;
constexpr double kNowhere_mm = -1.0;

/// Distance along the ray to the last of the cuts behind which it starts.
double entryOf(const render::Ray &ray, const std::vector<render::CutPlane> &cuts) {
  double entry = 0.0;
  for (const render::CutPlane &cut : cuts) {
    const double beyond = dot(ray.origin - cut.point, cut.normal), away = dot(ray.direction, cut.normal);
    if (beyond > 0.0) entry = std::max(entry, away < 0.0 ? -beyond / away : kNeverWithin_mm);
  }
  return std::min(entry, kNeverWithin_mm);
}

}  // namespace

void ViewController::setViewSize(int width, int height) {
  width_ = std::max(width, 1);
  height_ = std::max(height, 1);
}

c3de_event toolEvent(const ViewInput &input, std::uint32_t type, std::uint32_t buttons, const render::Ray &ray,
                     const Vec3 &view) {
  c3de_event event{};
  event.size = sizeof event;
  event.type = type;
  event.button = input.button;
  event.buttons = buttons;
  event.modifiers = input.modifiers;
  event.key = input.key;
  event.x_px = input.x;
  event.y_px = input.y;
  event.wheel = input.wheel;
  event.time_s = input.time_s;
  event.inside_mm = kNowhere_mm;
  for (std::size_t i = 0; i < 3; ++i) {
    event.ray_origin_mm[i] = ray.origin[i];
    event.ray_direction[i] = ray.direction[i];
    event.view_direction[i] = view[i];
  }
  return event;
}

bool ViewController::sendToTool(const ViewInput &input, std::uint32_t type) {
  render::Ray ray = camera_.pickRay(input.x, input.y, width_, height_);
  if (type == C3DE_EVENT_PRESS) ray.origin = ray.origin + entryOf(ray, cuts_) * ray.direction;
  c3de_event event = toolEvent(input, type, buttons_, ray, camera_.forward());
  if (type == C3DE_EVENT_PRESS && findInside_) event.inside_mm = findInside_(ray).value_or(kNowhere_mm);
  return tools_.dispatch(event);
}

ViewController::Drag ViewController::dragOf(const ViewInput &input) {
  if (input.button == C3DE_BUTTON_MIDDLE) return Drag::pan;
  if (input.button == C3DE_BUTTON_RIGHT) return Drag::zoom;
  if (input.modifiers & C3DE_MOD_SHIFT) return Drag::pan;
  if (input.modifiers & C3DE_MOD_CTRL) return Drag::zoom;
  return sendToTool(input, C3DE_EVENT_PRESS) ? Drag::tool : Drag::orbit;
}

bool ViewController::handle(const ViewInput &input) {
  const double dx = input.x - lastX_, dy = input.y - lastY_;
  lastX_ = input.x;
  lastY_ = input.y;
  // If the tool is no longer active, the registry has cancelled it.
  if (drag_ == Drag::tool && tools_.active() != dragTool_) drag_ = Drag::none;

  switch (input.kind) {
    case ViewInput::Kind::press: {
      const bool isFirst = buttons_ == 0;
      buttons_ |= input.button;
      if (!isFirst) return drag_ == Drag::tool && sendToTool(input, C3DE_EVENT_PRESS);
      dragButton_ = input.button;
      dragTool_ = tools_.active();
      drag_ = dragOf(input);
      return true;
    }
    case ViewInput::Kind::release: {
      buttons_ &= ~input.button;
      const bool isToolsOwn = drag_ == Drag::tool;
      if (input.button == dragButton_) drag_ = Drag::none;
      return isToolsOwn && sendToTool(input, C3DE_EVENT_RELEASE);
    }
    case ViewInput::Kind::move:
      switch (drag_) {
        case Drag::tool: return sendToTool(input, C3DE_EVENT_MOVE);
        case Drag::orbit: camera_.orbit(dx, dy, height_); return true;
        case Drag::pan: camera_.pan(dx, dy, height_); return true;
        case Drag::zoom: camera_.zoom(-dy / kPixelsPerZoomStep); return true;
        case Drag::none: return buttons_ == 0 && sendToTool(input, C3DE_EVENT_MOVE);
      }
      return false;
    case ViewInput::Kind::wheel:
      if (!sendToTool(input, C3DE_EVENT_WHEEL)) camera_.zoom(input.wheel);
      return true;
    case ViewInput::Kind::key: return sendToTool(input, C3DE_EVENT_KEY);
  }
  return false;
}

void ViewController::cancel() {
  tools_.cancelActive();
  drag_ = Drag::none;
}

void resetCamera(render::Camera &camera) {
  const bool isPatient = camera.upAxis == render::UpAxis::z;
  camera.yaw = isPatient ? 0.6 : render::Camera().yaw;
  camera.pitch = isPatient ? 0.3 : render::Camera().pitch;
}

void lookAlong(render::Camera &camera, const Vec3 &direction) {
  constexpr double kQuarter = std::numbers::pi / 2.0;
  // The six standard directions are quarter turns; the camera defines which sign belongs to which.
  const double limit = 89.9 / 180.0 * std::numbers::pi;
  double best = -2.0, bestYaw = camera.yaw, bestPitch = camera.pitch;
  for (const double pitch : {0.0, limit, -limit})
    for (int turn = 0; turn < 4; ++turn) {
      render::Camera tried = camera;
      tried.yaw = turn * kQuarter;
      tried.pitch = pitch;
      const double alignment = dot(tried.forward(), direction);
      if (alignment <= best + 1e-9) continue;
      best = alignment;
      bestYaw = tried.yaw;
      bestPitch = tried.pitch;
    }
  camera.yaw = bestYaw;
  camera.pitch = bestPitch;
}

}  // namespace c3de::ui
