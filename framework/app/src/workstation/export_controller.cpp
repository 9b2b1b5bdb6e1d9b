// SPDX-License-Identifier: Apache-2.0
#include "workstation/export_controller.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "c3de/abi/log.h"
#include "c3de/core/output_file.h"
#include "c3de/core/path_text.h"
#include "c3de/imaging/label_names.h"
#include "c3de/imaging/reading.h"
#include "c3de/ui/file_browser.h"

namespace c3de::app {

ExportCallback ExportController::reportAs(const char *done, const char *failed) const {
  return [this, done, failed](const Expected<std::string> &written) {
    if (written)
      parts_.panels.notify(C3DE_LOG_INFO, done, *written);
    else
      parts_.failed(failed, written.error());
  };
}

void ExportController::connect(ui::WindowActions &actions) {
  using Path = std::filesystem::path;
  Session &session = parts_.session;
  const ExportCallback report = reportAs("Exported", "The export could not be written");
  actions.exportSurface = [&session, report](const Path &file) { exportPresentSurface(session, file, report); };
  actions.exportFrame = [&session, report](const Path &file) { exportPresentFrame(session, file, report); };
  actions.exportImage = [this](const Path &file) { exportImage({file, {}, {}}); };
  actions.exportLabels = [this](const Path &file) { exportImage({{}, {}, file}); };
  actions.exportDisplacement = [this](const Path &file) { exportImage({{}, file, {}}); };
  actions.exportTissues = [this, report](const Path &file) {
    exportPresentTissues(parts_.session, parts_.tissues.tracker().bodies(), file, report);
  };
  actions.saveState = [this](const Path &file) {
    savePresentState(parts_.session, file, reportAs("Saved", "The state could not be saved"));
  };
  actions.loadState = [this](const Path &file) {
    goToStateOf(parts_.session, file, reportAs("Loaded", "The state could not be loaded, and nothing has changed"));
  };
  actions.saveScanScene = [this](const Path &file) { saveScanScene(file); };
  actions.proposeName = [this](ui::Command exported) { return proposedName(exported); };
}

void ExportController::exportImage(const ImageExport &wanted) {
  const ui::ImageViews &views = parts_.images.views();
  const FixedRegions still = views.image() ? parts_.warp.fixedRegions() : FixedRegions{};
  // Shares ownership of the object that contains the label map.
  const std::shared_ptr<const imaging::LabelMap> labels =
      still.labels ? std::shared_ptr<const imaging::LabelMap>(still.labels, &still.labels->map) : nullptr;
  const segmentation::ScanBody::Sources &open = parts_.images.scanBody().sources();
  exportPresentImage(parts_.session,
                     {views.sharedImage(), open.layers, !open.layers.empty() && open.imageFile == open.labelFile},
                     {parts_.warp.falloff_mm(), still.rule, labels, still.tissues}, wanted,
                     reportAs("Exported", "The export could not be written"));
}

void ExportController::saveScanScene(const std::filesystem::path &file) {
  const auto written = writeWholeFile(file, parts_.images.scanBody().sceneText(file.parent_path()));
  if (written)
    parts_.panels.notify(C3DE_LOG_INFO, "Saved", "The scene of the scan: " + pathText(file));
  else
    parts_.failed("The scene could not be saved", written.error());
}

/// Named after the image or the simulation, what is written of it, and its time.
std::string ExportController::proposedName(ui::Command exported) const {
  Session &session = parts_.session;
  const scene::StoredImage *image = parts_.images.views().image();
  const scene::Node *node = session.sceneGraph().find(session.simulationNode());
  const bool isOfImage = exported == ui::Command::exportImage || exported == ui::Command::exportLabels ||
                         exported == ui::Command::exportDisplacement || exported == ui::Command::saveLabels ||
                         exported == ui::Command::saveStatistics || (exported == ui::Command::saveFigure && !node);
  std::string name = isOfImage && image ? imaging::nameFromFile(pathFromText(image->name))
                     : node             ? node->name
                                        : std::string();
  if (name.empty()) name = isOfImage ? "image" : "bodies";
  name = ui::fileNamePart(name);
  if (exported == ui::Command::exportImage) name += "-deformed";
  if (exported == ui::Command::exportLabels) name += "-labels-deformed";
  if (exported == ui::Command::exportDisplacement) name += "-displacement";
  if (exported == ui::Command::saveLabels) return name + "-labels";
  if (exported == ui::Command::saveStatistics) return name + "-statistics";
  if (exported == ui::Command::exportTissues) name += "-tissues";
  if (exported == ui::Command::exportResiduals) return name + "-residuals";
  if (exported == ui::Command::saveFigure) name += "-figure";
  if (exported == ui::Command::saveSessionAs) return name;
  if (scene::Simulation *simulation = session.simulation()) name += fmt::format("-{:.3f}s", simulation->state().time_s);
  return name;
}

}  // namespace c3de::app
