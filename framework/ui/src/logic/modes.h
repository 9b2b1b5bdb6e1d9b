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

/// Who gets the mouse and the keys, and what Escape and Undo mean: decided here and nowhere else. What a person is
/// doing lies in layers; an event goes to the uppermost one that is there and wants it.
///
///  layer   there while                  mouse                   keys                      Escape
///  above   a menu, a list, a dialog or  all of it               all but Ctrl+Q, and       closes menus and lists; what
///          a question is open                                   Undo for the scan's body  a dialog does is its own
///  drag    a button is held in a view   stays with that view    as below                  lets go; so does a click
///                                                                                         that is awaited in a slice
///  region  the region of the scan's     plain left drags in     Enter (of its bar), Undo  takes back the drag, else
///          body is drawn                slices                  and Redo                  ends it without keeping it
///  tool    one is active                in the 3D view, and in  its own                   lets go
///                                       slices if it wants
///  views   always                       camera, cross-hair      slice keys over a slice,  a step that takes long is
///                                                               commands, shortcuts       paused
///
/// Nothing is drawn here, and what Dear ImGui has open is told by Above. Main thread.
class Modes {
 public:
  /// What lies above the views.
  struct Above {
    bool isPopup = false;     ///< a menu, a list, a dialog or a question
    bool isFile = false;      ///< of these, the one that asks for a file
    bool isQuestion = false;  ///< of these, one that has to be answered
    bool isTyping = false;    ///< in a field
    bool takesKeys = false;   ///< a widget is being used
  };
  /// What is left to do about a key.
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

  /// Once per frame, before its events. Of the last one: where the views are, by Pane, and what lies over them.
  void beginFrame(const std::array<PixelRect, 4> &panes, const std::vector<PixelRect> &overlays);
  [[nodiscard]] Answer takeKey(const OsEvent &event, const Above &above);
  /// Press, release, move and wheel, in window pixels.
  void takeMouse(const OsEvent &event, const Above &above);
  /// The window has lost mouse and keys: everything that is held is let go.
  void loseFocus();
  /// What the tool holds is let go; it stays active.
  void cancelTool();
  /// The view that the mouse belongs to there. None: the side panel, an overlay, or what lies above.
  [[nodiscard]] std::optional<Pane> paneAt(double x, double y, const Above &above) const;
  [[nodiscard]] std::uint32_t buttons() const { return buttons_; }
  [[nodiscard]] ViewController &space() { return *space_; }

  void undo(const Above &above);
  void redo();
  /// Of what they would do; empty: nothing.
  [[nodiscard]] std::string undoLabel() const;
  [[nodiscard]] std::string redoLabel() const;
  /// Escape has been taken in this frame: it is not meant for a dialog that is drawn in it.
  [[nodiscard]] bool isEscapeTaken() const { return isEscapeTaken_; }
  void takeEscape() { isEscapeTaken_ = true; }

  /// The region of the scan's body is drawn; the dialog that asks about it stands aside. Null: it is not.
  [[nodiscard]] RegionDrawing *region() { return region_ ? &*region_ : nullptr; }
  /// Nothing happens without an image. @param handle_px  size of a handle
  void beginRegion(double handle_px);
  /// Each frame: it ends where nothing is left to be drawn for.
  void followRegion();
  /// @param isKept  the scan gets the region, else it stays as it was
  void endRegion(bool isKept);

 private:
  [[nodiscard]] ImageViews *images() const {
    return services_.images && services_.images->image() ? services_.images : nullptr;
  }
  /// The dialog of the scan's body is what is answered.
  [[nodiscard]] bool isScanAsked(const Above &above) const;
  [[nodiscard]] bool isEscapeForRegion();
  /// With the position in the window.
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
};

}  // namespace c3de::ui
