// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/measurement_tools.h"

#include <cmath>
#include <limits>
#include <utility>

#include "c3de/ui/commands.h"
#include "c3de/ui/image_views.h"
#include "logic/seen_inside.h"
#include "logic/tool_event.h"

namespace c3de::ui {
namespace {

Vec3 vec(const double *p) { return {p[0], p[1], p[2]}; }

std::size_t pointsOf(MeasureKind kind) {
  return kind == MeasureKind::landmark ? 1 : kind == MeasureKind::distance ? 2 : 3;
}

}  // namespace

void MeasurementTools::addTo(registry::ToolRegistry &tools) {
  struct Text {
    const char *id, *label, *hint;
    std::uint32_t shortcut;
  };
  static constexpr std::array<Text, 3> kTexts{
      {{"measure.landmark", "Landmark", "Click: place a landmark. Drag one: move it. Delete: remove it", 'L'},
       {"measure.distance", "Distance", "Click two points, or drag from one to the other. Esc: cancel", 'U'},
       {"measure.angle", "Angle", "Click three points; the second is the vertex. Esc: cancel", 'A'}}};
  registry_ = &tools;
  for (std::size_t i = 0; i < kTexts.size(); ++i) {
    tools_[i] = {this, static_cast<MeasureKind>(i)};
    registry::Tool tool;
    tool.id = kTexts[i].id;
    tool.label = kTexts[i].label;
    tool.hint = kTexts[i].hint;
    tool.shortcut = kTexts[i].shortcut;
    tool.inSlices = true;
    tool.self = &tools_[i];
    tool.cancel = [](void *self) noexcept { static_cast<Tool *>(self)->all->cancel(); };
    tool.onEvent = [](void *self, const c3de_event *event, std::uint32_t *consumed) noexcept -> c3de_status {
      const Tool &one = *static_cast<Tool *>(self);
      *consumed = one.all->handle(one.kind, *event) ? 1 : 0;
      return C3DE_OK;
    };
    const Handle added = tools.add(std::move(tool));
    if (tools_[i].kind == MeasureKind::landmark) landmarkTool_ = added;
  }
}

void MeasurementTools::placeTargetOf(const std::string &name) {
  if (registry_ == nullptr || !registry_->activate(landmarkTool_)) return;
  targetOf_ = name;
}

std::optional<std::pair<std::string, Vec3>> MeasurementTools::dragged() const {
  if (draggedName_.empty() || !hasDragged_) return std::nullopt;
  return std::pair(draggedName_, draggedAt_);
}

Vec3 MeasurementTools::shownAt(const MeasuredPoint &point, bool isInSlice) const {
  if (draggedName_ == point.name && hasDragged_) return draggedAt_;
  const bool isAtRest = isInSlice && parts_.images && parts_.images->isAtRest();
  return isAtRest ? point.reference_mm : parts_.list.positionOf(point);
}

bool MeasurementTools::showsRest(const c3de_event &event) const {
  return event.where != C3DE_IN_SPACE && parts_.images && parts_.images->isAtRest();
}

std::optional<Vec3> MeasurementTools::locate(const c3de_event &event) const {
  const Vec3 origin = vec(event.ray_origin_mm), direction = vec(event.ray_direction);
  if (event.where != C3DE_IN_SPACE) return origin;
  if (event.inside_mm >= 0.0) return origin + event.inside_mm * direction;
  const auto along = parts_.renderer ? nearestSurface(*parts_.renderer, {origin, direction}) : std::nullopt;
  return along ? std::optional(origin + *along * direction) : std::nullopt;
}

Vec3 MeasurementTools::inPlaneOf(const Vec3 &point, const c3de_event &event) const {
  const Vec3 origin = vec(event.ray_origin_mm), direction = vec(event.ray_direction),
             normal = vec(event.view_direction);
  if (event.where != C3DE_IN_SPACE) return origin;
  const double along = dot(direction, normal);
  return along == 0.0 ? point : origin + dot(point - origin, normal) / along * direction;
}

const MeasuredPoint *MeasurementTools::under(const c3de_event &event) const {
  const Vec3 origin = vec(event.ray_origin_mm), direction = vec(event.ray_direction);
  const std::optional<Pane> slice = slicePaneOf(event);
  const bool isInSlice = slice.has_value();
  const MeasuredPoint *nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const MeasuredPoint &one : parts_.list.set().points) {
    if (one.isHidden) continue;
    const Vec3 at = shownAt(one, isInSlice);
    const double along = dot(at - origin, direction);
    double reach_mm = 0.0;
    if (isInSlice) {
      if (!parts_.images) continue;
      const SliceView &view = parts_.images->view(*slice);
      if (std::abs(along) > 0.5 * view.step() + 1e-6) continue;
      reach_mm = kReach_px * view.millimetresPerPixel();
    } else {
      if (along < 0.0 || !parts_.space_mm) continue;
      reach_mm = kReach_px * parts_.space_mm(at);
    }
    const double away = norm(at - origin - along * direction) / reach_mm;
    if (away > 1.0 || away >= least) continue;
    least = away;
    nearest = &one;
  }
  return nearest;
}

bool MeasurementTools::handle(MeasureKind kind, const c3de_event &event) {
  switch (event.type) {
    case C3DE_EVENT_PRESS: return press(kind, event);
    case C3DE_EVENT_MOVE: move(event); return isDown_;
    case C3DE_EVENT_RELEASE:
      if (event.button != C3DE_BUTTON_LEFT || !isDown_) return false;
      release(kind, event);
      return true;
    case C3DE_EVENT_KEY:
      if (event.key != keyDelete || parts_.list.selected.empty()) return false;
      if (parts_.removed) parts_.removed(parts_.list.selected);
      return true;
    default: return false;
  }
}

bool MeasurementTools::press(MeasureKind kind, const c3de_event &event) {
  if (event.button != C3DE_BUTTON_LEFT) return false;
  pressX_ = event.x_px;
  pressY_ = event.y_px;
  hasDragged_ = false;
  if (!targetOf_.empty()) {
    const auto at = locate(event);
    if (!at) return false;
    isDown_ = true;
    follower_.reset();
    const std::string name = std::exchange(targetOf_, {});
    if (parts_.targeted) parts_.targeted(name, *at, event.where != C3DE_IN_SPACE);
    return true;
  }
  if (const MeasuredPoint *point = under(event)) {
    isDown_ = true;
    parts_.list.selected = point->name;
    draggedAt_ = shownAt(*point, event.where != C3DE_IN_SPACE);
    if (kind == MeasureKind::landmark)
      draggedName_ = point->name;
    else
      add(kind, {point->name, draggedAt_, showsRest(event)});
    return true;
  }
  const auto at = locate(event);
  if (!at) return false;
  isDown_ = true;
  add(kind, {{}, *at, showsRest(event)});
  return true;
}

void MeasurementTools::move(const c3de_event &event) {
  const bool isFar = std::hypot(event.x_px - pressX_, event.y_px - pressY_) > kDrag_px;
  if (isDown_ && !draggedName_.empty() && (isFar || hasDragged_)) {
    draggedAt_ = inPlaneOf(draggedAt_, event);
    hasDragged_ = true;
  }
  follower_.reset();
  if (!pending_.empty())
    follower_ = inPlaneOf(pending_.back().at_mm, event);
  else if (const MeasuredPoint *point = parts_.list.set().point(targetOf_))
    follower_ = inPlaneOf(shownAt(*point, event.where != C3DE_IN_SPACE), event);
}

void MeasurementTools::release(MeasureKind kind, const c3de_event &event) {
  isDown_ = false;
  const bool isFar = std::hypot(event.x_px - pressX_, event.y_px - pressY_) > kDrag_px;
  if (!draggedName_.empty()) {
    const std::string name = std::exchange(draggedName_, {});
    const Vec3 at = locate(event).value_or(draggedAt_);
    if (std::exchange(hasDragged_, false) && parts_.moved) parts_.moved(name, {name, at, showsRest(event)});
    return;
  }
  if (kind != MeasureKind::distance || pending_.size() != 1 || !isFar) return;
  if (const MeasuredPoint *point = under(event))
    add(kind, {point->name, shownAt(*point, event.where != C3DE_IN_SPACE), showsRest(event)});
  else if (const auto at = locate(event))
    add(kind, {{}, *at, showsRest(event)});
}

void MeasurementTools::add(MeasureKind kind, MeasurementPick pick) {
  // A point is not measured to itself.
  for (const MeasurementPick &one : pending_)
    if (norm(one.at_mm - pick.at_mm) == 0.0) return;
  pending_.push_back(std::move(pick));
  if (pending_.size() < pointsOf(kind)) return;
  follower_.reset();
  if (parts_.placed) parts_.placed(kind, std::exchange(pending_, {}));
}

void MeasurementTools::cancel() {
  pending_.clear();
  follower_.reset();
  draggedName_.clear();
  targetOf_.clear();
  hasDragged_ = isDown_ = false;
}

}  // namespace c3de::ui
