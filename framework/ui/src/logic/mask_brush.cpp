// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/mask_brush.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "c3de/registry/tool_registry.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "logic/tool_event.h"

namespace c3de::ui {
namespace {

constexpr double kRadiusFactor = 1.25;  // of a key press
constexpr double kShortestPart = 0.25;  // of the radius: points of a path that are closer are left out
constexpr double kSamePlane_mm = 1e-6;

}  // namespace

MaskBrush::MaskBrush(registry::ToolRegistry &tools, ImageViews &images, segmentation::SegmentationWorkflow &workflow)
    : tools_(tools), images_(images), workflow_(workflow) {}

MaskBrush::~MaskBrush() { offer(false); }

void MaskBrush::offer(bool isOffered) {
  if (isOffered != tool_.isNull()) return;
  if (!isOffered) {
    if (isActive()) tools_.activate({});
    tools_.remove(std::exchange(tool_, {}));
    return;
  }
  registry::Tool tool;
  tool.owner = "c3de";
  tool.id = "segmentation.brush";
  tool.label = "Brush";
  tool.hint = "Paint the mask in a slice; [ and ] change the radius, E erases, Ctrl+Z undoes a stroke";
  tool.shortcut = 'K';
  tool.inSlices = true;
  tool.self = this;
  tool.activate = onActivate;
  tool.cancel = onCancel;
  tool.onEvent = onEvent;
  tool_ = tools_.add(std::move(tool));
}

bool MaskBrush::isActive() const { return !tool_.isNull() && tools_.active() == tool_; }

void MaskBrush::toggle() { tools_.activate(isActive() ? Handle{} : tool_); }

std::optional<MaskBrush::Marker> MaskBrush::marker() const {
  if (!isActive() || !pane_) return {};
  const segmentation::BrushSettings &brush = workflow_.settings().brush;
  return Marker{*pane_, centre_, path_, brush.radius_mm, brush.isErasing, workflow_.colour()};
}

c3de_status C3DE_CALL MaskBrush::onActivate(void *self) {
  static_cast<MaskBrush *>(self)->pane_.reset();
  return C3DE_OK;
}

/// A drag in progress is discarded.
void C3DE_CALL MaskBrush::onCancel(void *self) {
  MaskBrush &brush = *static_cast<MaskBrush *>(self);
  brush.isDown_ = false;
  brush.path_.clear();
  brush.reference_.clear();
}

c3de_status C3DE_CALL MaskBrush::onEvent(void *self, const c3de_event *event, std::uint32_t *consumed) {
  *consumed = static_cast<MaskBrush *>(self)->handle(*event) ? 1 : 0;
  return C3DE_OK;
}

bool MaskBrush::handle(const c3de_event &event) {
  if (event.type == C3DE_EVENT_KEY) return pressKey(event.key);
  const std::optional<Pane> pane = slicePaneOf(event);
  if (!pane || !images_.image()) {
    if (!isDown_) pane_.reset();
    return false;
  }
  if (isDown_ && pane != pane_) return true;
  const Vec3 world{event.ray_origin_mm[0], event.ray_origin_mm[1], event.ray_origin_mm[2]};
  pane_ = pane;
  centre_ = world;
  switch (event.type) {
    case C3DE_EVENT_PRESS:
      if (event.button != C3DE_BUTTON_LEFT || isDown_) return isDown_;
      normal_ = {event.view_direction[0], event.view_direction[1], event.view_direction[2]};
      press(world);
      return true;
    case C3DE_EVENT_MOVE:
      if (isDown_) extend(world);
      return isDown_;
    case C3DE_EVENT_RELEASE:
      if (!isDown_ || event.button != C3DE_BUTTON_LEFT) return isDown_;
      finish();
      isDown_ = false;
      return true;
    default: return false;
  }
}

void MaskBrush::press(const Vec3 &world) {
  isDown_ = true;
  path_ = {world};
  reference_ = {images_.referenceAt(world)};
}

void MaskBrush::extend(const Vec3 &world) {
  // A wheel has moved the slice: each slice has a stroke of its own.
  if (std::abs(dot(world - path_.back(), normal_)) > kSamePlane_mm) {
    finish();
    return press(world);
  }
  if (norm(world - path_.back()) < kShortestPart * workflow_.settings().brush.radius_mm) return;
  path_.push_back(world);
  reference_.push_back(images_.referenceAt(world));
}

void MaskBrush::finish() {
  path_.clear();
  if (!reference_.empty()) workflow_.paint(std::exchange(reference_, {}), normal_);
}

bool MaskBrush::pressKey(std::uint32_t key) {
  segmentation::BrushSettings brush = workflow_.settings().brush;
  switch (key) {
    case '[': brush.radius_mm = std::max(kSmallest_mm, brush.radius_mm / kRadiusFactor); break;
    case ']': brush.radius_mm = std::min(kLargest_mm, brush.radius_mm * kRadiusFactor); break;
    case 'E': brush.isErasing = !brush.isErasing; break;
    default: return false;
  }
  workflow_.setBrush(brush);
  return true;
}

}  // namespace c3de::ui
