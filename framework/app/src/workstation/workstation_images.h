// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/reading.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/segmentation/scan_body.h"
#include "c3de/session/session.h"
#include "c3de/ui/image_panel.h"
#include "c3de/ui/preferences.h"
#include "c3de/ui/segmentation_panel.h"
#include "workstation/displacement_presenter.h"
#include "workstation/latest_job.h"
#include "workstation/mask_surface.h"
#include "workstation/messages.h"
#include "workstation/series_choice.h"
#include "workstation/workstation_labels.h"

namespace c3de::render {
class Renderer;
}

namespace c3de::app {

/// Opens images and label maps without blocking the window. Reading runs in a background job, and only complete data
/// replaces what was open. Main thread. Must outlive the session's jobs, and the renderer must outlive it.
class WorkstationImages {
 public:
  struct Events {
    std::function<void()> shown;   ///< another image is in the views
    std::function<void()> closed;  ///< no image is open any more
    ReportError failed;
    std::function<void(std::vector<segmentation::BodyRequest>)> createBodies;
    std::function<void(const std::string &body, std::shared_ptr<const imaging::Mask>,
                       const segmentation::SegmentationWorkflow::MaskRange &)>
        updateBody;
    std::function<void(const std::string &scene)> createScanBody;  ///< ends with scanBody().finished()
    std::function<void()> closeSimulation;
    std::function<void()> askForLabelFile;  ///< ends with saveLabels()
    std::function<void()> selectionRestored;
    /// The user wants the image that was open before as a second scan over the present one.
    std::function<void(const std::filesystem::path &, const std::string &series)> compareWith;
  };
  WorkstationImages(Session &session, render::Renderer &renderer, registry::PanelRegistry &panels,
                    registry::ToolRegistry &tools, Events events);
  ~WorkstationImages();

  [[nodiscard]] ui::ImageViews &views() { return views_; }
  [[nodiscard]] segmentation::SegmentationWorkflow &workflow() { return workflow_; }
  [[nodiscard]] segmentation::ScanBody &scanBody() { return scanBody_; }
  [[nodiscard]] const ui::MaskBrush &brush() const { return brush_; }
  /// How to open a segmentation that is opened as an image.
  enum class Segmentation {
    labels,  ///< overlaid on the open image; if there is none, on its own label numbers
    image    ///< overlaid on its own label numbers, replacing the open image
  };
  /// Opens a file, a DICOM folder or any file of its series, and ends a running load. If there are several series, a
  /// panel asks for one.
  /// @param isOfSimulation  the present simulation, or one that is being opened, belongs to it
  void open(const std::filesystem::path &path, std::vector<std::filesystem::path> labels = {},
            const std::string &series = {}, std::size_t time = 0, Segmentation segmentation = Segmentation::labels,
            bool isOfSimulation = false);
  [[nodiscard]] bool hasImage() const { return views_.image() != nullptr; }
  /// File or folder of the open image, and of its label maps.
  [[nodiscard]] const std::filesystem::path &file() const { return path_; }
  /// Series of the open image; empty: the only or first one.
  [[nodiscard]] const std::string &series() const { return series_; }
  [[nodiscard]] std::vector<std::filesystem::path> labelFiles() const { return labels_.files(); }
  /// Overlays a label map on the open image.
  void openLabels(const std::filesystem::path &path) { labels_.open(path); }
  /// Writes the open label map with what is picked as one of its labels, in a background job.
  void saveLabels(const std::filesystem::path &path);
  /// Writes volume and image values of what is picked and of each label as CSV, in a background job.
  void saveStatistics(const std::filesystem::path &path);
  /// What is picked or painted has not changed since it was saved as a label map.
  [[nodiscard]] bool isMaskSaved() const { return savedRevision_ == workflow_.mask().revision(); }
  /// Selects this when the label maps of the image have been read. Call when the image is shown.
  void restoreSelection(segmentation::Selection selection) { toRestore_ = std::move(selection); }
  /// The outlines of the bodies replace their labels, and none of them is selected any more.
  void onBodiesReady(const std::vector<segmentation::BodyRequest> &requests);
  /// The bodies have been removed: their labels are shown again.
  void onBodiesRemoved() { labels_.showHiddenLabels(); }
  /// Window and level of images that are opened from now on.
  void setWindowLevelRules(std::vector<ui::WindowLevelRule> rules) { windowLevelRules_ = std::move(rules); }
  void close();
  /// Shows the displacement of the tissue; null: none.
  void showDisplacement(std::shared_ptr<const imaging::DisplacementGrid> displacement);
  /// Called after the user has chosen the overlay of the slices.
  void followOverlay() { displacement_.followOverlay(); }
  /// Marks the parts of bodies' masks that are in no body, also in an image opened later, and reports them.
  /// @param isNew  replaces the previous marks; otherwise they are added
  void showMissing(const std::vector<Coverage> &bodies, bool isNew);
  /// Applies the visibility of the image's node.
  void followNode();

 private:
  void show(std::shared_ptr<scene::StoredImage> image, bool isOfSimulation);
  /// @param name  modality, series description and file name
  void applyWindowLevelRule(const std::string &name);
  void offerToCloseSimulation(const std::string &image);
  /// @param former  file of the image that was open before
  void offerToCompare(const std::filesystem::path &former, const std::string &series);
  /// Reads another time point of the open image and replaces it.
  void readTime(std::size_t time);
  void showTime(std::shared_ptr<scene::StoredImage> image);
  /// Updates scanBody_ with what is open.
  void updateScanBodySources();
  void showPreview();
  void applyRestored();
  void reportRestored();
  void markMissing();
  void askForSeries(const std::filesystem::path &path, std::vector<std::filesystem::path> labels,
                    std::vector<imaging::SeriesInfo> series);

  Session &session_;
  render::Renderer &renderer_;
  registry::PanelRegistry &panels_;
  Events events_;
  ui::ImageViews views_;
  DisplacementPresenter displacement_;
  std::optional<ui::ImagePanel> panel_;
  segmentation::SegmentationWorkflow workflow_;
  ui::MaskBrush brush_;
  segmentation::ScanBody scanBody_;
  WorkstationLabels labels_;
  std::optional<ui::SegmentationPanel> segmentationPanel_;
  std::unique_ptr<SeriesChoice> choice_;
  std::filesystem::path path_;  ///< of the open image
  std::string series_;
  std::vector<ui::WindowLevelRule> windowLevelRules_;
  MaskSurface maskSurface_;
  LatestJob job_, timeJob_;
  Handle node_, storedImage_;
  std::shared_ptr<const segmentation::MaskPreview> preview_;  ///< the displayed preview
  std::vector<Coverage> coverage_;
  std::optional<std::uint64_t> savedRevision_;
  std::optional<segmentation::Selection> toRestore_;
  bool isRestoring_ = false;
};

}  // namespace c3de::app
