// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "c3de/abi/simulation.h"
#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/render/camera.h"
#include "c3de/render/renderer.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/figure.h"
#include "c3de/ui/preferences.h"
#include "c3de/ui/recent_files.h"
#include "c3de/ui/stretch.h"
#include "c3de/ui/window_services.h"

namespace c3de::ui {

struct WindowOptions {
  std::string title = "C3DE";
  int width = 1280, height = 800;
  /// File that mirrors the window as JSON for scripts and tests (contents: see automation_state.h); empty: none.
  std::filesystem::path automationState;
};

/// Files to open, from the menu, the dialog or a drop on the window.
struct OpenRequest {
  std::vector<std::filesystem::path> files;
  std::string meshUnit;    ///< mm, cm, m; empty: the unit stated in each file, else mm
  bool areLabels = false;  ///< the images are label maps to be overlaid on the open image
};

/// A class that can simulate what is opened next.
struct SimulatorChoice {
  std::string id, label, plugin;
  bool isChosen = false;
};

/// A file that contains a plugin, or should.
struct PluginEntry {
  enum class State { loaded, refused, shadowed, off };
  std::string id;    ///< empty: unknown
  std::string name;  ///< display name
  std::string version, vendor, license, file;
  State state = State::loaded;
  std::string reason;       ///< why it is not loaded
  bool isOn = true;         ///< from the next start on
  bool hasChanged = false;  ///< the user has switched it since this start
  unsigned crashes = 0;     ///< number of runs that it has crashed
  std::string lastCrash{};  ///< "ended by SIGSEGV, …": of the last crash
};

/// The replay of a recording, as its bar shows it. A position is the number of steps since the recording began.
struct ReplayView {
  struct Mark {
    std::uint64_t position = 0;
    std::string text;  ///< what was changed
  };
  std::string file;
  std::shared_ptr<const std::vector<Mark>> marks;
  std::function<double(std::uint64_t position)> timeAt_s;  ///< simulated time since the recording began
  std::uint64_t position = 0, target = 0, length = 0;
  bool isPlaying = false, isSeeking = false;
  double rate = 1.0;    ///< simulated seconds per second; 0: as fast as possible
  bool hasNow = false;  ///< the simulation from before the replay was kept
  std::string warning;  ///< for example "differs from the recording at step 300"
  Stretch stretch;
  bool hasProbes = false;
  std::string whyNoFilm;         ///< why no film can be made; empty: it can
  std::filesystem::path folder;  ///< of the recording
  std::string exporting;         ///< what is being exported, and how far it is; empty: nothing
};

/// Requests of the bar of a replay.
struct ReplayActions {
  std::function<void(std::uint64_t position)> seek;
  std::function<void(bool plays)> play;
  std::function<void()> step, cancel;
  std::function<void(double rate)> setRate;
  std::function<void()> returnToNow;
  std::function<void()> leave;             ///< the simulation becomes an ordinary one
  std::function<void()> setBegin, setEnd;  ///< of the stretch, at the present position
  std::function<void(const StretchExport &)> exportStretch;
};

/// Why values, tools and commands are disabled during a replay.
inline constexpr const char *kReplayLocks =
    "A recording is replayed, and nothing can be changed. Continue from here, in the bar below, ends the replay.";

/// What the user wants in a report about a problem.
struct ReportRequest {
  std::string description;  ///< what happened
  bool hasImage = false;    ///< the images of the simulation are in it
};
/// What a report would contain.
struct ReportContents {
  bool isMeasured = false;
  std::string recording;            ///< "from t = 0 s to t = 1.2 s, 300 steps", or why there is none
  std::string size, sizeWithImage;  ///< before compression
  bool needsImage = false;          ///< without images the recording cannot be in it
};

/// Figures and screenshots.
struct FigureActions {
  std::function<FigureSettings()> settings;  ///< of the last figure
  std::function<void(const FigureSettings &, const std::filesystem::path &)> save;
  std::function<void()> copy;              ///< to the clipboard, with the settings of the last figure
  std::function<std::string()> whyNoCopy;  ///< why it cannot be copied; empty: it can
  std::function<ScreenshotSize()> screenshotSize;
  std::function<void(ScreenshotSize)> setScreenshotSize;
};

/// What the user prefers. The window shows a change at once, by setPreferences().
struct PreferenceActions {
  std::function<void(const Preferences &)> change;
  std::function<void()> restore;  ///< the usual values, except of bookmarks and recent folders
  std::function<std::filesystem::path()> file;
};

/// The strip of curves.
struct PlotActions {
  std::function<void(bool isShown)> show;                                     ///< values are gathered while it is shown
  std::function<void(const std::filesystem::path &)> saveTable, savePicture;  ///< of the shown curves
};

/// Requests of the window to the program. Called on the main thread, in drawFrame().
struct WindowActions {
  std::function<void(const OpenRequest &)> open;
  std::function<void()> reload;
  std::function<void(std::uint32_t action)> transport;  ///< C3DE_TRANSPORT_*
  std::function<void(double rate)> setTargetRate;       ///< 0: as fast as possible
  std::function<std::vector<SimulatorChoice>()> simulators;
  std::function<void(const std::string &id)> chooseSimulator;
  std::function<std::vector<PluginEntry>()> plugins;
  std::function<void(const std::string &id, bool isOn)> switchPlugin;  ///< from the next start on
  std::function<void()> screenshot;
  FigureActions figures;
  PreferenceActions preferences;
  PlotActions plots;
  std::function<void(const std::filesystem::path &)> exportSurface, exportFrame;  ///< the present state
  std::function<std::string()> surfaceExtensions;                                 ///< "obj;stl", the proposed one first
  std::function<void(const std::filesystem::path &)> saveState, loadState;        ///< of the simulation
  std::function<void(const std::filesystem::path &)> saveStatistics;              ///< of the regions in the image
  std::function<void(const std::filesystem::path &)> saveLabels;                  ///< with the mask as a label
  /// Image and labels in the present state of the tissue; its displacement
  std::function<void(const std::filesystem::path &)> exportImage, exportLabels, exportDisplacement;
  std::function<void(const std::filesystem::path &)> exportTissues;  ///< motion of the labels
  /// Landmarks, their targets; measurements over time
  std::function<void(const std::filesystem::path &)> loadLandmarks, loadTargetLandmarks, saveLandmarks, exportCurves;
  std::function<void(const std::filesystem::path &)> saveScanScene;  ///< of the settings in the scan dialog
  /// Proposed name for a file of that export, without folder and extension; empty: no proposal.
  std::function<std::string(Command exported)> proposeName;
  std::function<void(const std::filesystem::path &)> openComparison;  ///< a second scan over the image
  std::function<void()> closeComparison;
  std::function<void()> matchBody;                                     ///< opens the panel that matches a body
  std::function<void(const std::filesystem::path &)> exportResiduals;  ///< of the last match
  std::function<std::string()> whyNoResiduals;                         ///< why there are none; empty: there are some
  std::function<void()> closeImage, closeSimulation;
  std::function<std::string()> unsaved;  ///< what quitting now would lose, as display text; empty if nothing
  /// Writes the session; `saved` is called after it is complete on the disk, and not after a failure.
  std::function<void(const std::filesystem::path &, std::function<void()> saved)> saveSession;
  std::function<void(const std::filesystem::path &)> saveSessionWithFiles;
  /// Calls back with the number and size of these files, as display text.
  std::function<void(std::function<void(const std::string &)> measured)> measureSession;
  std::function<void(const std::filesystem::path &)> startRecording;
  std::function<void()> stopRecording, showTimeline;
  std::function<void(const ReportRequest &, const std::filesystem::path &)> saveReport;
  std::function<void()> measureReport;  ///< begins to count; the result is in reportContents
  std::function<const ReportContents &()> reportContents;
  ReplayActions replay;
  std::function<std::filesystem::path()> sessionFile;    ///< empty: not saved yet
  std::function<std::string()> title;                    ///< of the window
  std::function<void(const RecentFile &)> removeRecent;  ///< from the list of recent files
  std::function<void()> clearRecent;
  std::function<void()> refreshRecent;  ///< the list is about to be shown
  std::function<void()> beforeDraw;     ///< panels have been handled, the 3D view is about to be drawn
};

/// For Help > About.
struct AboutText {
  std::string version, graphics;
};

/// A choice the user must make before the program continues.
struct Question {
  struct Answer {
    std::string id, label;
  };
  std::string id, title, text;
  std::vector<Answer> answers;  ///< Enter selects the first, Escape the last
};

/// The state of the present simulation for toolbar and status bar.
struct SimulationView {
  bool exists = false;
  std::string title;
  c3de_sim_transport transport{};
  std::string recording;                     ///< file that it is recorded in; empty: none
  bool hasTimeline = false;                  ///< it is being recorded, or was
  std::shared_ptr<const ReplayView> replay;  ///< null: none
  std::string activity;  ///< what takes long in the step being computed, and what would help; may be empty

  static constexpr double kLongStep_s = 0.15;
  /// Whether a step takes long, or each of a sequence does; displayed as long as this lasts.
  [[nodiscard]] bool isLongStep() const {
    return exists && (transport.step_running_s > kLongStep_s ||
                      (transport.mode == C3DE_SIM_PLAYING && transport.step_ms > 1e3 * kLongStep_s));
  }
};

/// The program's window: an OpenGL context, menus, panels, the 3D view and its input. Main thread, except wake().
class WorkstationWindow {
 public:
  /// OpenGL 4.5 core, or 4.3 if nothing newer is available. ErrorCode::graphics names what was found and what is
  /// required.
  [[nodiscard]] static Expected<std::unique_ptr<WorkstationWindow>> create(const WindowOptions &options);
  ~WorkstationWindow();

  void connect(const WindowServices &services, WindowActions actions);
  void setAbout(AboutText about);
  /// Applies them from the next frame on.
  void setPreferences(const Preferences &preferences);

  /// Draws frames until the question is answered; may be called before connect(). Returns the id of the answer: the
  /// last one if the window is closed instead.
  [[nodiscard]] std::string ask(const Question &question, render::Renderer &renderer);

  /// Waits until a frame is due: at once after input, at most 60 times a second while something moves, otherwise
  /// indefinitely.
  /// @return whether the frame shows new data. Where frames are slow and input is waiting, the frame only responds to
  /// the input and shows everything else as in the last frame. The next frame then shows the new data.
  [[nodiscard]] bool waitForFrame();
  /// Processes input, draws the scene with the renderer and everything around it, and presents the frame.
  void drawFrame(render::Renderer &renderer, const SimulationView &simulation);
  /// Ends a waitForFrame(). Any thread.
  void wake();

  [[nodiscard]] bool closeRequested() const;
  /// Closes the window, without a question, once the function returns true. It is called at least once a second.
  void closeWhen(std::function<bool()> isAskedToEnd);
  void requestClose();
  /// Opens the dialog that saves a report about a problem, as its command does.
  void openReport();

  [[nodiscard]] render::Camera &camera();
  /// Size of the 3D view in framebuffer pixels; size of all views while it is hidden.
  [[nodiscard]] int viewWidth() const;
  [[nodiscard]] int viewHeight() const;
  /// Width / height of all views together.
  [[nodiscard]] double viewsAspect() const;
  /// All views as last drawn, in framebuffer pixels, without texts. Empty: nothing was drawn yet, or not enough
  /// graphics memory.
  [[nodiscard]] std::optional<render::Image> viewPicture() const;
  /// Fits everything visible into the view as soon as the scene has bounds.
  void requestFit();
  /// Executes a command of the menus in the next frame.
  void request(Command command);
  /// Same, then looks as this camera does: focus, yaw, pitch and distance.
  void requestPose(const render::Camera &pose);
  /// Writes the automation state now (also before the program ends).
  void writeAutomationState();

 private:
  struct Impl;
  explicit WorkstationWindow(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::ui
