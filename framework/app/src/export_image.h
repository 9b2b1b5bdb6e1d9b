// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/abi/draft/iface/simulator.h"
#include "c3de/core/expected.h"
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

/// Before the simulation begins: that the scene has an image, and that the files can be written. Errors: usage, output.
[[nodiscard]] Expected<void> checkImageExport(const ImageExport &wanted, const scene::SceneFile &scene);
/// Of the simulator's present state. [sim]
[[nodiscard]] Expected<void> exportImages(const ImageExport &wanted, const scene::SceneFile &scene,
                                          const c3de_simulator_v0 *table, c3de_object *simulator, ThreadPool &threads);

}  // namespace c3de::app
