// SPDX-License-Identifier: Apache-2.0
// What the parts of the window share while one frame is drawn.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/ui/commands.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/tissue_table.h"
#include "c3de/ui/workstation_window.h"
#include "logic/modes.h"
#include "window/automation_state.h"
#include "window/steady_panel.h"
#include "window/theme.h"

namespace c3de::ui {

class FileDialog;

/// What a person can arrange; reset by "Reset layout".
struct Layout {
  float sideWidth = 360.0f;  ///< logical pixels
  bool resetSections = false;
};

/// A tooltip comes when the mouse has rested on its item for a while.
struct TooltipTimer {
  std::array<float, 2> item{};  ///< upper left corner of the item under the mouse
  double since_s = 0.0;
  bool isSeen = false;  ///< in this frame
  bool isWaiting = false;
};

/// Messages and running jobs below the panels, where they cover no image.
struct Dock {
  float height = 0.0f;                      ///< that the last frame needed
  std::map<std::uint64_t, double> since_s;  ///< when each message was first drawn, or last under the mouse
  double ends_s = 0.0;  ///< until the next of them goes by itself, from the last frame on; 0: none does
};

/// Lives as long as the window.
struct WindowState {
  TooltipTimer tooltip;
  Layout layout;
  bool showShortcuts = false, showAbout = false, showMessages = false, showPlugins = false;
  std::array<char, 128> labelFilter{};  ///< in the dialog of the scan's body
  std::array<char, 128> tissueFilter{};
  TissueOrder tissueOrder = TissueOrder::labels;
  std::optional<Question> question;  ///< while a person is asked
  /// To the last one: the ids of question and answer.
  std::pair<std::string, std::string> answer;
  AboutText about;
  std::map<std::string, std::array<AutomationState::Rect, 2>> openers;  ///< of closed menus and lists, and their clips
  Dock dock;
  SteadyPanel sideRows;             ///< of the side panel
  std::vector<PixelRect> overlays;  ///< over the view, of the last frame: the mouse belongs to them
  int framesToFit = 0;              ///< that bring everything visible into the view
};

struct FrameContext {
  const WindowServices &services;
  const WindowActions &actions;
  const SimulationView &simulation;
  const Theme &theme;
  AutomationState &automation;
  WindowState &state;
  Modes &modes;
  FileDialog &fileDialog;
  render::Camera &camera;
  std::vector<Command> commands{};   ///< to be carried out after the frame is described
  PixelRect area{};                  ///< of all views
  PixelRect view{};                  ///< of the 3D view; without extent while it is hidden
  std::array<PixelRect, 4> panes{};  ///< by Pane; the last is `view`
  std::array<int, 2> windowSize{};
  std::uint64_t frame = 0;
  double framesPerSecond = 0.0;
  double mouseX = 0.0, mouseY = 0.0;
  std::uint32_t mouseButtons = 0;
  bool isFocused = true;

  void request(Command command) { commands.push_back(command); }
  /// The images when there is one to show, else null.
  [[nodiscard]] ImageViews *shownImages() const {
    return services.images && services.images->image() ? services.images : nullptr;
  }
  [[nodiscard]] std::string activeToolId() const;
  /// At this moment.
  [[nodiscard]] Modes::Above above() const;
};

/// Makes the last ImGui item known to the automation state.
void markItem(const FrameContext &frame, const std::string &area, const std::string &id, bool enabled = true);

/// The same for an item that has opened a menu or list: inside it, the last item is another one, so the rectangle of
/// the last frame in which it was closed is taken.
void markOpener(const FrameContext &frame, const std::string &area, const std::string &id, bool isOpen,
                bool enabled = true);

inline constexpr double kTooltipDelay_s = 0.45;
/// A tooltip of the last item, wrapped; also where the item is disabled.
void itemTooltip(const FrameContext &frame, const std::string &text);

/// Text cut with "…" so that it is no wider than `width`.
[[nodiscard]] std::string elided(const std::string &text, float width);

}  // namespace c3de::ui
