// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app.h"
#include "c3de/registry/edit_list.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/registry/tool_registry.h"
#include "c3de/render/renderer.h"
#include "c3de/session/session.h"
#include "c3de/session/session_file.h"
#include "c3de/ui/comparison.h"
#include "c3de/ui/comparison_panel.h"
#include "c3de/ui/comparison_tools.h"
#include "c3de/ui/measurement_list.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/image_reading.h"
#include "workstation/latest_job.h"
#include "workstation/messages.h"
#include "workstation/series_choice.h"
#include "workstation/workstation_images.h"

namespace c3de::app {

/// A second scan over the open image: opens and aligns it, and restores that of a session. It is removed with the
/// image. Main thread. Must outlive the session's jobs; the renderer must outlive it.
class ComparisonController {
 public:
  struct Parts {
    Session &session;
    render::Renderer &renderer;
    registry::PanelRegistry &panels;
    registry::EditList &edits;
    registry::ToolRegistry &tools;
    WorkstationImages &images;
    ui::MeasurementList &measurements;
    ReportError failed;
    std::function<void()> restored;  ///< that of a session is shown, or could not be
  };
  explicit ComparisonController(Parts parts);
  ~ComparisonController();

  /// Adds the actions that open and close a second scan.
  void connect(ui::WindowActions &actions);
  /// Reads a file, or any file of a DICOM series, in a background job. The present second scan stays until it is
  /// complete.
  void open(const std::filesystem::path &path, const std::string &series = {});
  /// Opens that of a session, over the image that is shown.
  void restore(const std::filesystem::path &path, const SavedComparison &saved);
  /// Without a step of undo, and ends those of the present one.
  void close();
  /// As a step of undo, which keeps the scan in memory until another one is opened or the image is closed.
  void remove();
  /// As a session has it, without the name of the file; none: there is no second scan, and none is being restored.
  struct Shown {
    std::filesystem::path file;
    SavedComparison saved;
  };
  [[nodiscard]] std::optional<Shown> shown() const;
  /// As ui::Comparison::revision().
  [[nodiscard]] std::uint64_t revision() const { return comparison_.revision(); }
  /// A scan of a session is being read.
  [[nodiscard]] bool isRestoring() const { return pending_.has_value(); }

 private:
  void read(const ImageToRead &wanted);
  struct Removal;
  /// @param saved  how it is shown; null: as a new one
  /// @return  false: it could not be shown, and the reason has been reported
  bool show(const ImageToRead &wanted, const std::shared_ptr<const scene::StoredImage> &image,
            const SavedComparison *saved, std::vector<std::string> notices);
  void hide();
  /// Sentences about two scans that do not overlap, or are the same.
  [[nodiscard]] std::vector<std::string> noticesOf(const ImageToRead &wanted, bool isSame) const;
  void align(const std::filesystem::path &landmarks);
  void removeFromRenderer();

  Parts parts_;
  ui::Comparison comparison_;
  ui::ComparisonTools tools_;
  std::optional<ui::ComparisonPanel> panel_;
  std::unique_ptr<SeriesChoice> choice_;
  LatestJob job_;
  std::filesystem::path file_;  ///< of the shown one
  std::string series_;
  std::optional<Shown> pending_;  ///< of a session, while it is read
};

}  // namespace c3de::app
