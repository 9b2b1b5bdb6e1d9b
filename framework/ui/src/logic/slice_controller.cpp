// SPDX-License-Identifier: Apache-2.0
#include "c3de/ui/slice_controller.h"

#include "logic/tool_event.h"

namespace c3de::ui {
namespace {

std::uint32_t whereOf(Pane slice) {
  return slice == Pane::axial ? C3DE_IN_AXIAL : slice == Pane::sagittal ? C3DE_IN_SAGITTAL : C3DE_IN_CORONAL;
}

}  // namespace

std::optional<Pane> slicePaneOf(const c3de_event &event) {
  for (const Pane slice : kSlicePanes)
    if (event.where == whereOf(slice)) return slice;
  return {};
}

bool SliceController::sendToTool(const ImageViews &images, Pane slice, const ViewInput &input, std::uint32_t type) {
  const SliceView &view = images.view(slice);
  const Vec3 normal = view.frame().normal();
  c3de_event event = toolEvent(input, type, buttons_, {view.worldAt(input.x, input.y), normal}, normal);
  event.where = whereOf(slice);
  return tools_.dispatch(event);
}

bool SliceController::isToolsOwn(const ImageViews &images, Pane slice, const ViewInput &input) {
  const auto tell = [&](std::uint32_t type) { return sendToTool(images, slice, input, type); };
  switch (input.kind) {
    case ViewInput::Kind::press: {
      const bool isFirst = buttons_ == 0;
      buttons_ |= input.button;
      if (dragTool_) {
        (void)tell(C3DE_EVENT_PRESS);
        return true;
      }
      const bool isPlain =
          input.button == C3DE_BUTTON_LEFT && (input.modifiers & (C3DE_MOD_SHIFT | C3DE_MOD_CTRL)) == 0;
      if (!isFirst || !isPlain || images.isPicking() || !tell(C3DE_EVENT_PRESS)) return false;
      dragTool_ = tools_.active();
      return true;
    }
    case ViewInput::Kind::release:
      buttons_ &= ~input.button;
      if (!dragTool_) return false;
      if (input.button == C3DE_BUTTON_LEFT) dragTool_.reset();
      (void)tell(C3DE_EVENT_RELEASE);
      return true;
    case ViewInput::Kind::move:
      if (!dragTool_) return buttons_ == 0 && tell(C3DE_EVENT_MOVE);
      (void)tell(C3DE_EVENT_MOVE);
      return true;
    case ViewInput::Kind::wheel: return tell(C3DE_EVENT_WHEEL);
    case ViewInput::Kind::key: return !ImageViews::isSliceKey(input.key, input.modifiers) && tell(C3DE_EVENT_KEY);
  }
  return false;
}

bool SliceController::handle(ImageViews &images, Pane slice, const ViewInput &input) {
  // If the tool is no longer active, the registry has cancelled it.
  if (dragTool_ && *dragTool_ != tools_.active()) dragTool_.reset();
  if (isToolsOwn(images, slice, input)) return true;
  if (!images.handle(slice, input)) return false;
  // The position under the mouse has changed.
  if (dragTool_) (void)sendToTool(images, slice, input, C3DE_EVENT_MOVE);
  return true;
}

}  // namespace c3de::ui
