// SPDX-License-Identifier: Apache-2.0
// Data shared by the parts of the window while one frame is drawn.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "c3de/ui/commands.h"
#include "c3de/ui/figure.h"
#include "c3de/ui/image_views.h"
#include "c3de/ui/tissue_table.h"
#include "c3de/ui/workstation_window.h"
#include "frame/anchored_panel.h"
#include "frame/automation_state.h"
#include "frame/theme.h"
#include "logic/modes.h"

namespace c3de::ui {

class FileDialog;

/// Layout that the user can change; restored by "Reset layout".
struct Layout {
  float sideWidth = 360.0f;  ///< logical pixels
  bool resetSections = false;
};

/// A tooltip appears when the mouse has rested on its item for a while.
struct TooltipTimer {
  std::array<float, 2> item{};  ///< upper left corner of the item under the mouse
  double since_s = 0.0;
  bool isSeen = false;  ///< in this frame
  bool isWaiting = false;
};

/// Messages and running jobs below the panels, where they do not cover an image.
struct Dock {
  float height = 0.0f;                      ///< required by the last frame
  std::map<std::uint64_t, double> since_s;  ///< when each message was first drawn, or last under the mouse
  double ends_s = 0.0;  ///< time from the last frame until the next message disappears automatically; 0: none does
};

/// The page shown while there is neither image nor simulation.
struct StartPageState {
  bool isShown = false;               ///< in the last frame
  bool wasFocused = false;            ///< the window, in the last frame
  bool isMenuOpen = false;            ///< File > Open recent, in the last frame
  std::optional<std::size_t> marked;  ///< recent file that Enter opens; empty: the first that exists
  bool isMarkMoved = false;           ///< by a key: it is scrolled into view
};

/// The dialog that exports a stretch of a recording.
struct StretchDialog {
  bool isShown = false;
  std::string recording;  ///< for which folder and name are proposed
  StretchExport wanted;
  std::array<char, 1024> folder{};
  std::array<char, 128> name{};
  std::string problem;                           ///< of the last attempt
  std::vector<std::filesystem::path> toReplace;  ///< the user has been asked about them
};

/// The dialog that saves a report about a problem.
struct ReportDialog {
  bool isShown = false;
  bool isMeasured = false;  ///< counting was requested
  ReportRequest wanted;
  std::array<char, 8192> description{};
};

/// The dialog that finds commands.
struct CommandPalette {
  bool isShown = false;
  std::array<char, 128> words{};
  std::size_t chosen = 0;     ///< among those that match
  bool isFieldLeft = false;   ///< the field is to get the keyboard again
  bool placesCursor = false;  ///< behind its text
};

/// The dialog of the preferences.
struct PreferencesDialog {
  bool isShown = false, isFilled = false;  ///< filled: with what applies
  Preferences edited;                      ///< fields that are being typed in; the rest applies at once
  std::array<char, 1024> folder{};
  std::vector<std::array<char, 128>> words;  ///< of the rules
  std::string problem;                       ///< of the last entry
};

/// The dialog that saves a figure.
struct FigureDialog {
  bool isShown = false, isFilled = false;  ///< filled: with the settings of last time
  FigureSettings wanted;
};

/// The strip of curves below the views.
struct PlotStrip {
  bool isShown = false;
  float height = 190.0f;  ///< logical pixels
};

/// What is drawn differently in a figure.
struct FigureLook {
  bool isLight = false;        ///< the 3D view
  bool hasAnnotations = true;  ///< names, cross-hair, read-outs and axes
  std::string caption{};       ///< in the 3D view, otherwise in the first slice; may be empty
};

/// Exists as long as the window.
struct WindowState {
  TooltipTimer tooltip;
  Layout layout;
  bool showShortcuts = false, showAbout = false, showMessages = false, showPlugins = false;
  std::array<char, 128> labelFilter{};  ///< in the dialog of the scan's body
  std::array<char, 128> tissueFilter{};
  /// Field of the selected measurement: for which one, its text, and why the last text was refused.
  struct {
    std::string shownFor;
    std::array<char, 256> text{};
    std::string problem;
  } measurementName;
  TissueOrder tissueOrder = TissueOrder::labels;
  std::string title;                 ///< of the window
  std::optional<Question> question;  ///< while the user is being asked
  /// For the last question: the ids of question and answer.
  std::pair<std::string, std::string> answer;
  AboutText about;
  std::map<std::string, std::array<AutomationState::Rect, 2>> openers;  ///< of closed menus and lists, and their clip
                                                                        ///< rectangles
  Dock dock;
  StartPageState startPage;
  StretchDialog stretch;
  ReportDialog report;
  CommandPalette palette;
  Preferences preferences;
  PreferencesDialog preferencesDialog;
  std::string menuToOpen;     ///< by a key: the id of a menu of the menu bar
  bool isMenuWanted = false;  ///< Alt is down, and nothing else has been pressed since
  FigureDialog figure;
  PlotStrip plots;
  std::optional<std::uint64_t> scrubbed;  ///< position that the slider of the timeline is dragged to
  AnchoredPanel sideRows;                 ///< of the side panel
  Handle openedPanel;                     ///< that was scrolled into view last
  bool isSearchWanted = false;            ///< the search field of a panel receives the keyboard
  std::vector<PixelRect> overlays;        ///< over the view, of the last frame: they receive the mouse
  std::optional<render::Camera> pose;     ///< of the camera after fitting
  int framesToFit = 0;                    ///< frames in which everything visible is fitted into the view
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
  std::vector<Command> commands{};   ///< executed after the frame is described
  PixelRect area{};                  ///< of all views
  PixelRect view{};                  ///< of the 3D view; empty while it is hidden
  std::array<PixelRect, 4> panes{};  ///< by Pane; the last is `view`
  std::array<int, 2> windowSize{};
  std::uint64_t frame = 0;
  double framesPerSecond = 0.0;
  double mouseX = 0.0, mouseY = 0.0;
  std::uint32_t mouseButtons = 0;
  bool isFocused = true;
  const FigureLook *figure = nullptr;  ///< null: the window

  [[nodiscard]] bool hasAnnotations() const { return !figure || figure->hasAnnotations; }
  [[nodiscard]] bool isLight() const { return figure && figure->isLight; }
  void request(Command command) { commands.push_back(command); }
  /// The images if there is one to show, otherwise null.
  [[nodiscard]] ImageViews *shownImages() const {
    return services.images && services.images->image() ? services.images : nullptr;
  }
  [[nodiscard]] std::string activeToolId() const;
  /// State at this moment.
  [[nodiscard]] Modes::Above above() const;
};

/// Registers the last ImGui item in the automation state.
void markItem(const FrameContext &frame, const std::string &area, const std::string &id, bool enabled = true);

/// Same for an item that has opened a menu or list. The last item is then one inside the menu, so the item's rectangle
/// of the last frame in which it was closed is used.
void markOpener(const FrameContext &frame, const std::string &area, const std::string &id, bool isOpen,
                bool enabled = true);

inline constexpr double kTooltipDelay_s = 0.45;
/// A tooltip of the last item, wrapped; also shown if the item is disabled.
void itemTooltip(const FrameContext &frame, const std::string &text);

/// Text truncated with "…" so that it is no wider than `width`.
[[nodiscard]] std::string elided(const std::string &text, float width);

}  // namespace c3de::ui
