// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "c3de/ui/commands.h"
#include "c3de/ui/edit_history.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/slice_controller.h"
#include "c3de/ui/view_controller.h"
#include "c3de/ui/window_services.h"
#include "logic/os_event.h"
#include "logic/pixel_rect.h"
#include "logic/region_drawing.h"

namespace c3de::ui {

/// Dispatches mouse and keys, and decides what Escape and Undo do; no other code does. Interaction is organised in
/// layers: an event goes to the uppermost layer that is present and uses it.
///
///  layer   present while                mouse                   keys                      Escape
///  above   a menu, a list, a dialog or  all of it               all but Ctrl+Q, and       closes menus and lists;
///          a question is open                                   Undo for the scan's body  a dialog handles it itself
///  drag    a button is held in a view   stays with that view    as below                  ends it, also a click
///                                                                                         awaited in a slice
///  region  the region of the scan's     plain left drags in     Enter (of its bar), Undo  takes back the drag, else
///          body is drawn                slices                  and Redo                  discards the region
///  tool    one is active                in the 3D view, and in  its own                   releases what it holds
///                                       slices if it works
///                                       there
///  views   always                       camera, cross-hair      slice keys over a slice,  pauses a step that takes
///                                                               commands, shortcuts       long
///
/// Nothing is drawn here; Above reports what Dear ImGui has open. Main thread.
class Modes {
 public:
  /// What is open above the views.
  struct Above {
    bool isPopup = false;     ///< a menu, a list, a dialog or a question
    bool isFile = false;      ///< in particular, the file dialog
    bool isQuestion = false;  ///< in particular, a question that must be answered
    bool isTyping = false;    ///< in a text field
    bool takesKeys = false;   ///< a widget is being used
  };
  /// What the caller must still do about a key.
  struct Answer {
    Command command = Command::none;
    Handle pluginCommand{};
    bool closesMenus = false;   ///< those above a dialog
    bool endsLongStep = false;  ///< if there is one
  };

  /// @param camera  of the 3D view; must outlive this
  explicit Modes(render::Camera &camera);
  Modes(const Modes &) = delete;
  Modes &operator=(const Modes &) = delete;
  /// The services must outlive this.
  void connect(const WindowServices &services);

  /// Called once per frame, before its events. Arguments of the last frame: the rectangles of the views, by Pane, and
  /// of the overlays above them.
  void beginFrame(const std::array<PixelRect, 4> &panes, const std::vector<PixelRect> &overlays);
  /// While a recording is replayed: no tool is activated, nothing is undone, and no command of a plugin runs.
  void lockChanges(bool isLocked) { isLocked_ = isLocked; }
  [[nodiscard]] Answer handleKey(const OsEvent &event, const Above &above);
  /// Press, release, move and wheel, in window pixels.
  void handleMouse(const OsEvent &event, const Above &above);
  /// The window has lost mouse and keyboard: all drags and holds end.
  void loseFocus();
  /// The tool releases what it holds; it stays active.
  void cancelTool();
  /// The view that receives the mouse at a position. None: the side panel, an overlay, or what is open above.
  [[nodiscard]] std::optional<Pane> paneAt(double x, double y, const Above &above) const;
  [[nodiscard]] std::uint32_t buttons() const { return buttons_; }
  [[nodiscard]] ViewController &space() { return *space_; }

  void undo(const Above &above);
  void redo();
  /// What they would undo or redo; empty if nothing.
  [[nodiscard]] std::string undoLabel() const;
  [[nodiscard]] std::string redoLabel() const;
  /// Escape has been used in this frame: it does not apply to a dialog drawn in it.
  [[nodiscard]] bool isEscapeTaken() const { return isEscapeTaken_; }
  void consumeEscape() { isEscapeTaken_ = true; }

  /// The region of the scan's body is being drawn, and the scan dialog is hidden. Null if it is not.
  [[nodiscard]] RegionDrawing *region() { return region_ ? &*region_ : nullptr; }
  /// No effect without an image. @param handle_px  size of a handle
  void beginRegion(double handle_px);
  /// Called each frame: ends the drawing if there is nothing left to draw for.
  void followRegion();
  /// @param isKept  the scan gets the region; otherwise its region remains unchanged
  void endRegion(bool isKept);

 private:
  [[nodiscard]] ImageViews *images() const {
    return services_.images && services_.images->image() ? services_.images : nullptr;
  }
  /// The dialog of the scan's body receives the input.
  [[nodiscard]] bool isScanAsked(const Above &above) const;
  [[nodiscard]] bool isEscapeForRegion();
  /// Position relative to the window.
  bool handle(Pane pane, ViewInput input);
  [[nodiscard]] bool takeShortcut(const OsEvent &event);
  void press(const ViewInput &input, const Above &above);

  render::Camera &camera_;
  registry::ToolRegistry noTools_;
  WindowServices services_;
  std::optional<ViewController> space_;
  std::optional<SliceController> slices_;
  std::optional<RegionDrawing> region_;
  EditHistory history_;
  std::array<PixelRect, 4> panes_{};
  std::vector<PixelRect> overlays_;
  std::uint32_t buttons_ = 0;
  std::optional<Pane> pressedPane_;  ///< where the buttons that are down were pressed
  DoubleClick doubleClick_;
  bool isEscapeTaken_ = false;
  bool isLocked_ = false;
};

}  // namespace c3de::ui
