// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/session/session.h"
#include "c3de/session/simulator_access.h"
#include "c3de/ui/views_picture.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/measurement_controller.h"
#include "workstation/messages.h"
#include "workstation/workstation_images.h"

namespace c3de::app {

/// Writes figures and screenshots of the views. A figure is drawn one view per frame, so that the window shows the
/// progress and can cancel; encoding and writing run in the same background job. Main thread, except onPublished().
/// Must outlive the session; renderer and window must outlive it.
class FigureController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    ui::WorkstationWindow &window;
    render::Renderer &renderer;
    WorkstationImages &images;
    MeasurementController &measurements;
    ReportError failed;
  };
  explicit FigureController(Parts parts);
  ~FigureController();

  /// Adds the actions of figures and screenshots.
  void connect(ui::WindowActions &actions);
  /// Reads what captions state. [simulation's thread]
  void onPublished(const scene::Simulation &simulation);
  /// Another simulation, or none, is the present one. A figure that is being drawn is not written.
  void onRemoved();
  /// Another image, or none, is shown. A figure that is being drawn is not written.
  void onImageChanged();
  /// Writes curves as a picture, with the settings of the last figure. No frame of the window may be in progress.
  void savePlots(const ui::PlotList &plots, const ui::SimulationView &simulation, const std::filesystem::path &file);
  /// In which captions have forces.
  void setUnits(const ui::DisplayUnits &units) { units_ = units; }
  /// A figure is being drawn: what the views show must not change.
  [[nodiscard]] bool isDrawing() const { return drawing_ != nullptr; }
  /// Called once per frame, when the views show the last snapshot and no frame of the window is in progress.
  void draw(const ui::SimulationView &simulation);

 private:
  /// Writes the bytes, and returns the file.
  using Write = std::function<Expected<std::filesystem::path>(const std::vector<char> &bytes)>;
  /// What is encoded and written, passed from the main thread to the job.
  struct Picture;
  struct Drawing;
  struct Wanted {
    ui::FigureSettings settings;
    std::string name;  ///< of the file, for the job
    Write write;
    const char *saved, *failed;  ///< titles of the messages
  };
  struct Snapshot {
    double time_s = 0.0;
    std::vector<ProbeToolSample> tools;
  };
  void save(const ui::FigureSettings &settings, const std::filesystem::path &file);
  /// To the clipboard.
  void copy();
  void saveScreenshot();
  void begin(const Wanted &wanted, const ui::SimulationView &simulation);
  void endDrawing(Expected<render::Image> result);
  /// The figure that is being drawn ends with this message, outside of a frame of the window.
  void interrupt(const char *why);
  /// Encodes and writes in a background job, as soon as there is a result.
  void submit(const std::shared_ptr<Picture> &picture, const std::string &name, double dpi, Write write,
              const char *saved, const char *failed);
  [[nodiscard]] std::string captionOf(const ui::SimulationView &simulation);
  void remember(const std::string &key, const std::string &value);

  Parts parts_;
  registry::SettingsStore store_;
  ui::FigureSettings settings_;
  ui::DisplayUnits units_;
  ui::ScreenshotSize screenshotSize_ = ui::ScreenshotSize::view;
  std::optional<Wanted> wanted_;  ///< begins with the next frame
  std::unique_ptr<Drawing> drawing_;
  std::mutex mutex_;
  std::optional<Snapshot> latest_;  ///< guarded by mutex_
};

/// "t = 0.42 s   needle: 1.2 N": time, and the magnitude of the force on each tool. Forces below a millionth of a
/// newton are 0.
[[nodiscard]] std::string figureCaption(double time_s, const std::vector<ProbeToolSample> &tools,
                                        const ui::DisplayUnits &units);

}  // namespace c3de::app
