// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/scene/image_store.h"
#include "c3de/session/export_image.h"
#include "c3de/session/session.h"
#include "c3de/session/tissue_motion.h"

namespace c3de::app {

/// Called on the main thread with the files that were written, one per line, or the error.
using ExportCallback = std::function<void(const Expected<std::string> &)>;

/// The present simulator: the class of the plugin that owns it. Main thread.
[[nodiscard]] Expected<SimulatorIdentity> presentSimulator(Session &session);

/// Writes the state of the simulation, or restores a saved one; on error everything remains unchanged. `told` receives
/// the file or the error.
void savePresentState(Session &session, const std::filesystem::path &file, ExportCallback told);
void goToStateOf(Session &session, const std::filesystem::path &file, ExportCallback told);

/// Writes the skins of the present state (surfaceFiles() determines the names). Runs between two steps on the
/// simulation's thread, so that all of it is of one moment. No effect without a simulation. Main thread.
void exportPresentSurface(Session &session, const std::filesystem::path &file, ExportCallback told);
/// Same, as a sequence of one frame: FILE.pvd and its folder.
void exportPresentFrame(Session &session, const std::filesystem::path &file, ExportCallback told);

/// What is open in the views.
struct PresentImages {
  std::shared_ptr<const scene::StoredImage> image;
  std::vector<std::shared_ptr<const scene::StoredLabels>> layers;  ///< of the label map over the image
  bool areLabels = false;                                          ///< that map is itself the image
};
/// One file of `wanted`: the deformed image or labels, or the displacement at the image's voxels. The displacement is
/// of one moment; warping and writing run in a background job.
void exportPresentImage(Session &session, const PresentImages &images, const ImageWarp &how, const ImageExport &wanted,
                        ExportCallback told);

/// Writes the motion of the labels of bodies of many tissues.
void exportPresentTissues(Session &session, std::shared_ptr<const std::vector<TissueVoxels>> bodies,
                          const std::filesystem::path &file, ExportCallback told);

}  // namespace c3de::app
