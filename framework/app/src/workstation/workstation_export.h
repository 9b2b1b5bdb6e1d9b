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

/// Told on the main thread: the files that were written, one a line, or why not.
using ExportTold = std::function<void(const Expected<std::string> &)>;

/// Writes the state of the simulation; goes to one that was saved, or leaves everything as it is. `told` hears the
/// file or why not.
void savePresentState(Session &session, const std::filesystem::path &file, ExportTold told);
void goToStateOf(Session &session, const std::filesystem::path &file, ExportTold told);

/// Writes the skins of the present state (surfaceFiles() says under which names), between two steps on the simulation's
/// thread, so that all of it is one moment. Nothing without a simulation. Main thread.
void exportPresentSurface(Session &session, const std::filesystem::path &file, ExportTold told);
/// The same as a sequence of one frame: FILE.pvd and its folder.
void exportPresentFrame(Session &session, const std::filesystem::path &file, ExportTold told);

/// What is open in the views.
struct PresentImages {
  std::shared_ptr<const scene::StoredImage> image;
  std::vector<std::shared_ptr<const scene::StoredLabels>> layers;  ///< of the label map over it
  bool areLabels = false;                                          ///< that map is the image
};
/// One file of `wanted`: the deformed image or labels, or how far the tissue has moved at the image's voxels.
/// The displacement is of one moment; warping and writing are a job beside the window.
void exportPresentImage(Session &session, const PresentImages &images, const ImageWarp &how, const ImageExport &wanted,
                        ExportTold told);

/// Writes what the labels of bodies of many tissues have done.
void exportPresentTissues(Session &session, std::shared_ptr<const std::vector<TissuePlaces>> bodies,
                          const std::filesystem::path &file, ExportTold told);

}  // namespace c3de::app
