// SPDX-License-Identifier: Apache-2.0
#include "logic/modes.h"

#include <algorithm>

#include "c3de/registry/command_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/segmentation/scan_body.h"

namespace c3de::ui {

Modes::Modes(render::Camera &camera) : camera_(camera) { connect({}); }

void Modes::connect(const WindowServices &services) {
  services_ = services;
  registry::ToolRegistry &tools = services.tools ? *services.tools : noTools_;
  space_.emplace(tools, camera_);
  slices_.emplace(tools);
}

void Modes::beginFrame(const std::array<PixelRect, 4> &panes, const std::vector<PixelRect> &overlays) {
  panes_ = panes;
  overlays_ = overlays;
  isEscapeTaken_ = false;
  history_.follow(services_.parameters, services_.workflow, services_.edits);
}

std::optional<Pane> Modes::paneAt(double x, double y, const Above &above) const {
  const auto isThere = [&](const PixelRect &rect) { return rect.contains(x, y); };
  if (above.isPopup || std::any_of(overlays_.begin(), overlays_.end(), isThere)) return {};
  for (const Pane pane : {Pane::axial, Pane::sagittal, Pane::coronal, Pane::space})
    if (isThere(panes_[static_cast<std::size_t>(pane)])) return pane;
  return {};
}

bool Modes::handle(Pane pane, ViewInput input) {
  const PixelRect &rect = panes_[static_cast<std::size_t>(pane)];
  input.x -= rect.x;
  input.y -= rect.y;
  if (pane == Pane::space) return space_->handle(input);
  if (region_ && region_->handle(pane, input)) return true;
  return images() && slices_->handle(*images(), pane, input);
}

void Modes::press(const ViewInput &input, const Above &above) {
  // Events are assigned by the position at which they happened, not by the mouse position when the frame begins.
  const bool isFirst = buttons_ == 0;
  if (isFirst) pressedPane_ = paneAt(input.x, input.y, above);
  buttons_ |= input.button;
  if (!pressedPane_) return;
  if (ImageViews *images = this->images(); images && isFirst) {
    if (doubleClick_.press(*pressedPane_, input)) {
      images->undoClick();
      images->setMaximised(images->maximised() ? std::nullopt : pressedPane_);
      pressedPane_.reset();  // the views have moved: the release is sent to none of them
      return;
    }
    images->forgetClick();
  }
  handle(*pressedPane_, input);
}

void Modes::handleMouse(const OsEvent &event, const Above &above) {
  using Kind = OsEvent::Kind;
  ViewInput input;
  input.button = event.button;
  input.modifiers = event.modifiers;
  input.wheel = event.wheel;
  input.time_s = event.time_s;
  input.x = event.x;
  input.y = event.y;
  const auto tell = [&](ViewInput::Kind kind, const std::optional<Pane> &pane) {
    input.kind = kind;
    if (pane) handle(*pane, input);
  };
  switch (event.kind) {
    case Kind::press: input.kind = ViewInput::Kind::press; return press(input, above);
    case Kind::release: buttons_ &= ~event.button; return tell(ViewInput::Kind::release, pressedPane_);
    case Kind::move: return tell(ViewInput::Kind::move, buttons_ != 0 ? pressedPane_ : paneAt(event.x, event.y, above));
    case Kind::wheel: return tell(ViewInput::Kind::wheel, paneAt(event.x, event.y, above));
    default: return;
  }
}

/// Cancels a drag of the box, otherwise the drawing, unless another drag or pick is in progress.
bool Modes::isEscapeForRegion() {
  if (!region_) return false;
  if (region_->cancelDrag()) return true;
  if (buttons_ != 0 || (images() && images()->isPicking())) return false;
  endRegion(false);
  return true;
}

Modes::Answer Modes::handleKey(const OsEvent &event, const Above &above) {
  if (event.key == 0) return {};
  const Command command = commandOfKey(event.key, event.modifiers);
  const bool isEscape = event.key == keyEscape && !event.isRepeat;
  if (command == Command::quit && !event.isRepeat) return {command};
  // A mouse button held over a slider also counts, but not one that drags in the view.
  if (isEscape && above.isPopup && !above.isTyping && !above.isFile) return {Command::none, {}, true};
  // The dialog of the scan's body has separate undo steps.
  if (command == Command::undo && above.isPopup && !above.isTyping && isScanAsked(above)) return {command};
  if (above.isTyping || above.isPopup || (above.takesKeys && !pressedPane_)) return {};
  ViewInput input;
  input.kind = ViewInput::Kind::key;
  input.key = event.key;
  input.modifiers = event.modifiers;
  input.time_s = event.time_s;
  input.x = event.x;
  input.y = event.y;
  const std::optional<Pane> under = paneAt(event.x, event.y, above);
  // Over a slice, slice keys are sent to the slice. They are the same in all slices, but the digit 1 has another
  // meaning for an image.
  if (under && *under != Pane::space && images() && ImageViews::isSliceKey(event.key, event.modifiers)) {
    handle(*under, input);
    return {};
  }
  if (event.isRepeat) return {};
  if (isEscape) {
    isEscapeTaken_ = isEscapeForRegion();
    if (isEscapeTaken_) return {};  // the dialog reappears in this frame
    if (services_.images) {
      services_.images->cancel();
      services_.images->cancelPick();
    }
    cancelTool();
    return {Command::none, {}, false, true};
  }
  if (command != Command::none) return {command};
  if (services_.commands && !isLocked_)
    if (const Handle found = services_.commands->ofKey(event.key, event.modifiers); !found.isNull())
      return {Command::none, found};
  if (takeShortcut(event) || event.key >= 0x80) return {};
  const std::optional<Pane> pane = buttons_ != 0 ? pressedPane_ : under;
  const bool isOfSlice = pane && *pane != Pane::space && services_.tools && services_.tools->worksInSlices();
  handle(isOfSlice ? *pane : Pane::space, input);
  return {};
}

/// Shortcut of a tool.
bool Modes::takeShortcut(const OsEvent &event) {
  if (event.modifiers != 0 || !services_.tools || !isFreeForTools(event.key)) return false;
  for (const registry::ToolRegistry::Entry &entry : services_.tools->tools())
    if (entry.tool->shortcut == event.key) {
      if (!isLocked_) services_.tools->activate(entry.handle);
      return true;
    }
  return false;
}

void Modes::cancelTool() {
  space_->cancel();
  slices_->cancel();
}

void Modes::loseFocus() {
  cancelTool();
  if (services_.images) services_.images->cancel();
  if (region_) (void)region_->cancelDrag();
  buttons_ = 0;
}

bool Modes::isScanAsked(const Above &above) const {
  const segmentation::ScanBody *scan = services_.scanBody;
  return scan && scan->isShown() && !scan->isHiddenTemporarily() && !above.isQuestion && !above.isFile;
}

void Modes::undo(const Above &above) {
  if (region_) return region_->undo();
  if (isScanAsked(above)) return services_.scanBody->undo();
  // The tool's current action ends, and is the first to be undone.
  if (services_.tools) services_.tools->cancelActive();
  history_.follow(services_.parameters, services_.workflow, services_.edits);
  history_.undo();
}

void Modes::redo() { region_ ? region_->redo() : history_.redo(); }

std::string Modes::undoLabel() const {
  if (region_) return region_->region().canUndo() ? "region" : "";
  return history_.undoLabel();
}

std::string Modes::redoLabel() const {
  if (region_) return region_->region().canRedo() ? "region" : "";
  return history_.redoLabel();
}

void Modes::beginRegion(double handle_px) {
  if (images() && services_.scanBody) region_.emplace(*images(), *services_.scanBody, handle_px);
}

void Modes::followRegion() {
  if (region_ && !region_->follow()) endRegion(false);
}

void Modes::endRegion(bool isKept) {
  if (!region_) return;
  if (isKept) region_->keep();
  region_->end();
  region_.reset();
}

}  // namespace c3de::ui
