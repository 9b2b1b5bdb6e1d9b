// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "app.h"
#include "c3de/registry/panel_registry.h"
#include "c3de/session/session.h"
#include "c3de/ui/workstation_window.h"
#include "workstation/messages.h"
#include "workstation/tissue_table_controller.h"
#include "workstation/warp_controller.h"
#include "workstation/workstation_export.h"
#include "workstation/workstation_images.h"

namespace c3de::app {

/// Writes what the window exports, and saves and restores the state of the simulation. Main thread. Must outlive the
/// session.
class ExportController {
 public:
  struct Parts {
    Session &session;
    registry::PanelRegistry &panels;
    WorkstationImages &images;
    WarpController &warp;
    TissueTableController &tissues;
    ReportError failed;
  };
  explicit ExportController(Parts parts) : parts_(std::move(parts)) {}

  /// Adds the actions that export, save and load.
  void connect(ui::WindowActions &actions);

 private:
  /// Reports the written file as a message.
  [[nodiscard]] ExportCallback reportAs(const char *done, const char *failed) const;
  void exportImage(const ImageExport &wanted);
  void saveScanScene(const std::filesystem::path &file);
  [[nodiscard]] std::string proposedName(ui::Command exported) const;

  Parts parts_;
};

}  // namespace c3de::app
