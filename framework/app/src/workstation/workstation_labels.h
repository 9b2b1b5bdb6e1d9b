// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/segmentation/scan_body.h"
#include "c3de/segmentation/segmentation_workflow.h"
#include "c3de/session/session.h"
#include "c3de/ui/image_panel.h"
#include "workstation/latest_job.h"
#include "workstation/messages.h"

namespace c3de::app {

/// The label maps of the open image, one of which is overlaid on it. They are read in background jobs. Main thread. Must
/// outlive the session's jobs.
class WorkstationLabels {
 public:
  struct Parts {
    Session &session;
    render::Renderer &renderer;
    registry::PanelRegistry &panels;
    ui::ImageViews &views;
    segmentation::SegmentationWorkflow &workflow;  ///< receives the shown map as a source
  };
  struct Events {
    std::function<void()> shown;   ///< another map is shown
    std::function<void()> loaded;  ///< no map is waiting any more
    ReportError failed;
  };
  WorkstationLabels(const Parts &parts, Events events)
      : parts_(parts), events_(std::move(events)), job_(parts.session.jobs()) {}

  /// Reads the map after those that are waiting, adds it and shows it.
  void open(const std::filesystem::path &path);
  /// Closes all maps, also those that are waiting.
  void close();
  [[nodiscard]] bool isLoading() const { return job_.isRunning() || !waiting_.empty(); }
  /// Of all maps, each once.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// For the panel of the image, which offers the maps.
  [[nodiscard]] ui::ImagePanel::LabelMaps choices();
  /// File and layers of the shown map.
  void addTo(segmentation::ScanBody::Sources &sources) const;
  /// Hides the labels of which bodies have been created, or shows them again.
  void hideLabelsOf(const std::vector<segmentation::BodyRequest> &requests);
  void showHiddenLabels();

 private:
  struct OpenLabels {
    std::filesystem::path path;
    std::shared_ptr<const scene::StoredLabels> labels;
    std::vector<std::uint16_t> hidden;  ///< because their bodies exist
  };
  /// Result of a reading job: one map, or the layers of a segmentation.
  struct ReadLabels {
    std::vector<std::shared_ptr<const scene::StoredLabels>> layers;
    std::vector<std::string> notices;
  };
  void readNext();
  void add(const std::filesystem::path &path, ReadLabels &read);
  void show(const OpenLabels &open);
  void remove();
  [[nodiscard]] std::size_t shown() const;

  Parts parts_;
  Events events_;
  std::vector<OpenLabels> maps_;
  std::deque<std::filesystem::path> waiting_;
  LatestJob job_;
  Handle stored_;
};

}  // namespace c3de::app
