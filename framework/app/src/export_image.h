// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/abi/draft/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/scene_file.h"

namespace c3de {
class ThreadPool;
}

namespace c3de::app {

/// What of the deformed scan is written; empty paths: not wanted. NRRD, NIfTI or MetaImage, by extension.
struct ImageExport {
  std::filesystem::path image;         ///< the scene's image as the tissue now lies, on its own grid and in its own type
  std::filesystem::path displacement;  ///< u(x) in mm at its voxels (x, y, z in LPS): the material at x was at x - u
  [[nodiscard]] bool isWanted() const { return !image.empty() || !displacement.empty(); }
};

/// Before the simulation begins: that the files can be written, and the scene's image, so that one that cannot be read costs
/// no run. Empty where nothing is wanted. Errors: usage, output, those of reading.
[[nodiscard]] Expected<imaging::LoadedVolume> imageToExport(const ImageExport &wanted, const scene::SceneFile &scene);
/// Of the simulator's present state. [sim]
/// @param image  of imageToExport()
[[nodiscard]] Expected<void> exportImages(const ImageExport &wanted, const imaging::Volume &image, double rim_mm,
                                          const c3de_simulator_v0 *table, c3de_object *simulator, ThreadPool &threads);

}  // namespace c3de::app
