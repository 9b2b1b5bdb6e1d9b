// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/settings_store.h"
#include "c3de/session/session.h"
#include "c3de/ui/plots.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/figure_controller.h"
#include "workstation/measurement_controller.h"
#include "workstation/messages.h"

namespace c3de::app {

/// Curves over simulated time: reads the report of the simulator after published snapshots while the strip is shown,
/// and takes measurements from their list. Reading takes a tenth of the time at most. Main thread, except onPublished().
/// Must outlive the session.
class PlotController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    MeasurementController &measurements;
    FigureController &figures;
    ReportError failed;
  };
  explicit PlotController(Parts parts) : parts_(std::move(parts)) {}

  [[nodiscard]] ui::PlotList &plots() { return plots_; }
  /// Adds the actions of the strip.
  void connect(ui::WindowActions &actions);
  /// [simulation's thread]
  void onPublished(const scene::Simulation &simulation);
  /// Another simulation, or none, is the present one.
  void onRemoved();
  /// Called before a frame.
  void update();
  /// Called once per frame, when no frame of the window is in progress.
  void drawPicture(const ui::SimulationView &simulation);

 private:
  struct Sample {
    double time_s = 0.0;
    std::vector<ui::PlotValue> values;
  };
  void addMeasurements();
  void saveTable(const std::filesystem::path &file);

  Parts parts_;
  ui::PlotList plots_;
  std::atomic<bool> isShown_{false};
  std::uint64_t measuredRevision_ = 0;           ///< of the positions of the last measurements
  std::optional<std::filesystem::path> wanted_;  ///< picture
  std::mutex mutex_;
  std::vector<Sample> waiting_;  ///< guarded by mutex_; bounded
  std::chrono::steady_clock::time_point last_{};
  std::chrono::steady_clock::duration took_{};
};

}  // namespace c3de::app
