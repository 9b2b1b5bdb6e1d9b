// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "app.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/session/landmark_tracker.h"
#include "c3de/session/session.h"
#include "c3de/session/session_file.h"
#include "c3de/ui/measurement_list.h"
#include "c3de/ui/measurement_tools.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"
#include "workstation/workstation_images.h"
#include "workstation/workstation_loader.h"

namespace c3de::app {

/// As a session has them, and back.
[[nodiscard]] SavedMeasurements savedOf(const ui::MeasurementSet &set);
[[nodiscard]] ui::MeasurementSet setOf(const SavedMeasurements &saved);

/// Landmarks, distances and angles of the window: their tools, their files, and their positions in the tissue of the
/// present simulation. Main thread, except onPublished(). Must outlive the session.
class MeasurementController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    registry::EditList &edits;
    registry::ToolRegistry &tools;
    WorkstationImages &images;
    ui::WorkstationWindow &window;
    const render::Renderer &renderer;
    ReportError failed;
  };
  explicit MeasurementController(Parts parts);

  [[nodiscard]] ui::MeasurementList &list() { return list_; }
  [[nodiscard]] ui::MeasurementTools &tools() { return tools_; }
  /// Adds the actions for landmark files and curves.
  void connect(ui::WindowActions &actions);
  /// Another simulation is the present one: landmarks of its scene are shown. Those of a session are set by its
  /// controller; undo and recordings keep the present ones.
  void onLoaded(const WorkstationLoader::Loaded &loaded);
  /// Bodies were added or removed.
  void onBodiesChanged();
  /// The simulation was closed: everything is shown at rest.
  void onRemoved();
  /// Called before a frame.
  void update();
  /// [simulation's thread]
  void onPublished(const scene::Simulation &simulation) { tracker_.onPublished(simulation); }

 private:
  using Resolved = std::function<void(const std::vector<Vec3> &reference_mm)>;
  void place(ui::MeasureKind kind, const std::vector<ui::MeasurementPick> &picks);
  /// In a slice that shows a second scan: where the point is in that scan.
  void placeTarget(const std::string &name, const Vec3 &at_mm, bool isInSlice);
  /// Positions at rest of what was clicked, found on the simulation's thread.
  void resolve(const std::vector<ui::MeasurementPick> &picks, Resolved done);
  void load(const std::filesystem::path &file);
  void loadTargets(const std::filesystem::path &file);
  void save(const std::filesystem::path &file);
  void exportCurves(const std::filesystem::path &file);
  void follow();
  [[nodiscard]] std::shared_ptr<const scene::SceneFile> presentScene() const;

  Parts parts_;
  ui::MeasurementList list_;
  ui::MeasurementTools tools_;
  LandmarkTracker tracker_;
  std::shared_ptr<const LandmarkTracker::Positions> shown_;
  std::uint64_t followedRevision_ = 0;
  bool isRefollowed_ = false, hadSimulation_ = false;
  std::string reportedProblem_;
};

}  // namespace c3de::app
