// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/comparison_tools.h"

#include <cmath>
#include <utility>

#include "c3de/registry/tool_registry.h"
#include "logic/tool_event.h"

namespace c3de::ui {
namespace {

/// About an axis of length 1 through a point.
Mat4 turnAbout(const Vec3 &point, const Vec3 &axis, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Mat4 m = kIdentity4;
  for (std::size_t column = 0; column < 3; ++column) {
    Vec3 e{};
    e[column] = 1.0;
    const Vec3 turned = c * e + s * cross(axis, e) + ((1.0 - c) * axis[column]) * axis;
    for (std::size_t r = 0; r < 3; ++r) m[4 * column + r] = turned[r];
  }
  const Vec3 moved = transformPoint(m, point);
  for (std::size_t r = 0; r < 3; ++r) m[12 + r] = point[r] - moved[r];
  return m;
}

}  // namespace

void ComparisonTools::offer(bool isOffered) {
  if (isOffered != tools_[0].handle.isNull()) return;
  if (!isOffered) {
    for (Tool &one : tools_) {
      if (registry_.active() == one.handle) registry_.activate({});
      registry_.remove(std::exchange(one.handle, {}));
    }
    return;
  }
  for (const bool isTurn : {false, true}) {
    Tool &one = tools_[isTurn ? 1 : 0];
    one = {this, isTurn, {}};
    registry::Tool tool;
    tool.owner = "c3de";
    tool.id = isTurn ? "comparison.turn" : "comparison.move";
    tool.label = isTurn ? "Turn scan" : "Move scan";
    tool.hint = isTurn ? "Drag in a slice: rotate the second scan about the cross-hair. Esc: cancel, Ctrl+Z: undo"
                       : "Drag in a slice: move the second scan in its plane. Esc: cancel, Ctrl+Z: undo";
    tool.shortcut = isTurn ? 'J' : 'V';
    tool.inSlices = true;
    tool.self = &one;
    tool.cancel = [](void *self) noexcept {
      ComparisonTools &all = *static_cast<Tool *>(self)->all;
      if (std::exchange(all.drag_, std::nullopt)) all.comparison_.cancelPreview();
    };
    tool.onEvent = [](void *self, const c3de_event *event, std::uint32_t *consumed) noexcept -> c3de_status {
      const Tool &sent = *static_cast<Tool *>(self);
      *consumed = sent.all->handle(sent, *event) ? 1 : 0;
      return C3DE_OK;
    };
    one.handle = registry_.add(std::move(tool));
  }
}

bool ComparisonTools::handle(const Tool &tool, const c3de_event &event) {
  if (!slicePaneOf(event) || !comparison_.isShown() || event.type == C3DE_EVENT_KEY) return false;
  const Vec3 world{event.ray_origin_mm[0], event.ray_origin_mm[1], event.ray_origin_mm[2]};
  switch (event.type) {
    case C3DE_EVENT_PRESS:
      if (event.button != C3DE_BUTTON_LEFT || drag_) return drag_.has_value();
      drag_ = Drag{world,
                   {event.view_direction[0], event.view_direction[1], event.view_direction[2]},
                   comparison_.worldFromSecond(),
                   0.0,
                   world};
      return true;
    case C3DE_EVENT_MOVE:
      if (drag_) move(tool, world);
      return drag_.has_value();
    case C3DE_EVENT_RELEASE:
      if (!drag_ || event.button != C3DE_BUTTON_LEFT) return drag_.has_value();
      move(tool, world);
      drag_.reset();
      comparison_.finishPreview(tool.isTurn ? "rotate comparison" : "move comparison");
      return true;
    default: return false;
  }
}

void ComparisonTools::move(const Tool &tool, const Vec3 &world) {
  Drag &drag = *drag_;
  if (world == drag.last) return;
  Mat4 moved = drag.pose;
  if (tool.isTurn) {
    const Vec3 pivot = images_.crossHair(), n = (1.0 / norm(drag.normal)) * drag.normal;
    const auto inPlane = [&](const Vec3 &p) { return (p - pivot) - dot(p - pivot, n) * n; };
    const Vec3 a = inPlane(drag.last), b = inPlane(world);
    drag.angle_rad += std::atan2(dot(n, cross(a, b)), dot(a, b));
    moved = multiply(turnAbout(pivot, n, drag.angle_rad), drag.pose);
  } else {
    for (std::size_t r = 0; r < 3; ++r) moved[12 + r] += world[r] - drag.from[r];
  }
  drag.last = world;
  comparison_.preview(geometry::poseOf(moved, comparison_.centre_mm()));
}

}  // namespace c3de::ui
