// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "c3de/abi/simulation.h"
#include "c3de/core/expected.h"
#include "c3de/core/handle.h"
#include "c3de/render/camera.h"
#include "c3de/ui/commands.h"
#include "c3de/ui/window_services.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::ui {

struct WindowOptions {
  std::string title = "C3DE";
  int width = 1280, height = 800;
  /// File that mirrors the window as JSON for scripts and tests (automation_state.h says what is in it); empty: none.
  std::filesystem::path automationState;
};

/// Files a person wants to see, through the menu, the dialog or by dropping them on the window.
struct OpenRequest {
  std::vector<std::filesystem::path> files;
  std::string meshUnit;    ///< mm, cm, m; empty: what each file says, else mm
  bool areLabels = false;  ///< images: label maps, to be laid over the image that is open
};

/// A class that may simulate what is opened next.
struct SimulatorChoice {
  std::string id, label, plugin;
  bool isChosen = false;
};

/// A file that holds a plugin, or should.
struct PluginEntry {
  enum class State { loaded, refused, shadowed, off };
  std::string id;    ///< empty: not known
  std::string name;  ///< for people
  std::string version, vendor, license, file;
  State state = State::loaded;
  std::string reason;       ///< why it is not loaded
  bool isOn = true;         ///< from the next start on
  bool hasChanged = false;  ///< somebody has switched it since this start
  unsigned crashes = 0;     ///< runs that it has ended
  std::string lastCrash{};  ///< "ended by SIGSEGV, …": of the last of them
};

/// What the window asks the program to do. Called on the main thread, in drawFrame().
struct WindowActions {
  std::function<void(const OpenRequest &)> open;
  std::function<void()> reload;
  std::function<void(std::uint32_t action)> transport;  ///< C3DE_TRANSPORT_*
  std::function<void(double rate)> setTargetRate;       ///< 0: as fast as it goes
  std::function<std::vector<SimulatorChoice>()> simulators;
  std::function<void(const std::string &id)> chooseSimulator;
  std::function<std::vector<PluginEntry>()> plugins;
  std::function<void(const std::string &id, bool isOn)> switchPlugin;  ///< from the next start on
  std::function<void()> screenshot;
  std::function<void(const std::filesystem::path &)> exportSurface, exportFrame;  ///< the present state
  std::function<std::string()> surfaceExtensions;                                 ///< "obj;stl", the proposed one first
  std::function<void(const std::filesystem::path &)> saveState, loadState;        ///< of the simulation
  /// Image and labels as the tissue lies now; how far it has moved
  std::function<void(const std::filesystem::path &)> exportImage, exportLabels, exportDisplacement;
  std::function<void(const std::filesystem::path &)> exportTissues;  ///< what labels have done
  std::function<void(const std::filesystem::path &)> saveScanScene;  ///< of what is chosen in the dialog of the scan
  /// What a file of that export could be called, without folder and ending; empty: nothing is proposed.
  std::function<std::string(Command exported)> proposeName;
  std::function<void()> closeImage, closeSimulation;
  std::function<std::string()> unsaved;  ///< what quitting now would lose, for a person; empty: nothing
  std::function<void()> beforeDraw;      ///< panels have been handled, the 3D view is about to be drawn
};

/// For Help > About.
struct AboutText {
  std::string version, graphics;
};

/// Something a person has to choose before the program goes on.
struct Question {
  struct Answer {
    std::string id, label;
  };
  std::string id, title, text;
  std::vector<Answer> answers;  ///< Enter chooses the first, Escape the last
};

/// The state of the present simulation for toolbar and status bar.
struct SimulationView {
  bool exists = false;
  std::string title;
  c3de_sim_transport transport{};
  std::string activity;  ///< what takes long in the step that is being computed, and what would help; may be empty

  static constexpr double kLongStep_s = 0.15;
  /// Said while it lasts: a step takes long, or one after the other does.
  [[nodiscard]] bool isLongStep() const {
    return exists && (transport.step_running_s > kLongStep_s ||
                      (transport.mode == C3DE_SIM_PLAYING && transport.step_ms > 1e3 * kLongStep_s));
  }
};

/// The program's window: an OpenGL context, menus, panels, the 3D view and its input. Main thread, except wake().
class WorkstationWindow {
 public:
  /// OpenGL 4.5 core, or 4.3 where there is no more. ErrorCode::graphics names what was found and what is needed.
  [[nodiscard]] static Expected<std::unique_ptr<WorkstationWindow>> create(const WindowOptions &options);
  ~WorkstationWindow();

  void connect(const WindowServices &services, WindowActions actions);
  void setAbout(AboutText about);

  /// Draws frames until the question is answered; before connect(), too. Returns the id of the answer: the last one if
  /// the window is closed instead.
  [[nodiscard]] std::string ask(const Question &question, render::Renderer &renderer);

  /// Waits until a frame is due: at once after input, at most 60 times a second while something moves, else never.
  /// @return whether the frame is to show what is new. Where frames take long and input waits, it only answers that,
  ///   with everything else as the last frame has shown it; the next one takes what is new.
  [[nodiscard]] bool waitForFrame();
  /// Takes input, draws the scene through the renderer and everything around it, shows the frame.
  void drawFrame(render::Renderer &renderer, const SimulationView &simulation);
  /// Ends a waitForFrame(). Any thread.
  void wake();

  [[nodiscard]] bool closeRequested() const;
  /// Closes the window, without a question, once the function answers true; it is asked once a second at least.
  void closeWhen(std::function<bool()> isAskedToEnd);
  void requestClose();

  [[nodiscard]] render::Camera &camera();
  /// Pixels of the 3D view in the framebuffer; of all views while it is hidden.
  [[nodiscard]] int viewWidth() const;
  [[nodiscard]] int viewHeight() const;
  /// Brings everything visible into the view as soon as the scene has bounds.
  void requestFit();
  /// Writes the automation state now (also before the program ends).
  void writeAutomationState();

 private:
  struct Impl;
  explicit WorkstationWindow(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace c3de::ui
