// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/reading.h"
#include "c3de/imaging/still.h"
#include "c3de/scene/materials.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/tissue_places.h"

namespace c3de {
class ThreadPool;
}

namespace c3de::session {

class BodySources;

/// What of the deformed scan is written; empty paths: not wanted. NRRD, NIfTI or MetaImage, by extension.
struct ImageExport {
  /// The scene's image as the tissue now lies, on its own grid and in its own type
  std::filesystem::path image;
  /// u(x) in mm at its voxels (x, y, z in LPS): the material at x was at x - u. Beside it vacatedFile() is written.
  std::filesystem::path displacement;
  /// The deformed label map, on the grid of the image; labelFiles() lists what is written
  std::filesystem::path labels;
  [[nodiscard]] bool isWanted() const { return !image.empty() || !displacement.empty() || !labels.empty(); }
};

/// How an image goes with the bodies.
struct ImageWarp {
  double rim_mm = 10.0;                             ///< within it their displacement falls to nothing around them
  imaging::StillRule still;                         ///< what stays
  std::shared_ptr<const imaging::LabelMap> labels;  ///< that `still` speaks of; may be null
  std::shared_ptr<const std::vector<TissuePlaces>> tissues{};  ///< of bodies; null: there are none of many
};
/// That of a scene, whose image and labels are read if they are not yet. Errors: those of reading and of stillRuleOf(),
/// with the line of [image].
/// @param tissues  of its bodies; empty: they are not made yet
[[nodiscard]] Expected<ImageWarp> imageWarpOf(const scene::SceneFile &scene, BodySources &sources,
                                              const scene::MaterialLibrary &materials,
                                              const std::vector<TissuePlaces> &tissues = {});

/// Before the simulation begins: that there is an image whose grid they take, and that the files can be written.
/// Errors: usage, output.
[[nodiscard]] Expected<void> checkImageExport(const ImageExport &wanted, const scene::SceneFile &scene);
/// How far the tissue has moved, finer than what is shown live, wherever bodies are in the image. [sim]
[[nodiscard]] Expected<imaging::DisplacementGrid> presentDisplacement(const c3de_simulator_v1 *table,
                                                                      c3de_object *simulator,
                                                                      const imaging::Volume &image,
                                                                      const ImageWarp &how);
/// u.nrrd -> u-vacated.nrrd: 1 where a body has gone away and nothing is known of what is there now. The field itself
/// has no mark: it stays finite, as programs that resample with it need it.
[[nodiscard]] std::filesystem::path vacatedFile(const std::filesystem::path &displacement);
/// Whether the values of the scene's image are numbers of labels: it is one of its label maps, or a body is made from
/// its labels.
[[nodiscard]] bool isImageOfLabels(const scene::SceneFile &scene);
/// The layers of the label map that is exported: the last of [image], else that of the first body with labels. Errors:
/// those of reading, and that there is none.
[[nodiscard]] Expected<std::shared_ptr<const std::vector<imaging::LabelMap>>> labelsToExport(
    const scene::SceneFile &scene, BodySources &sources);
/// a.nrrd, a-2.nrrd, …: one for each layer.
[[nodiscard]] std::vector<std::filesystem::path> labelFiles(const std::filesystem::path &labels, std::size_t layers);
/// Warps and writes image and displacement. Any thread. The answer is for a person: the files, and how much of the image
/// is vacated.
/// @param areLabels  the values of the image are numbers of labels: the nearest is taken, nothing is interpolated
/// @param threads    null: the calling one alone
[[nodiscard]] Expected<std::string> writeImages(const ImageExport &wanted, const imaging::Volume &image, bool areLabels,
                                                const imaging::DisplacementGrid &u, const ProgressFn &progress,
                                                ThreadPool *threads);
/// Likewise of the label map: the nearest label at each voxel of the image.
/// @param layers  of labelsToExport()
/// @param grid    of the image
[[nodiscard]] Expected<std::string> writeLabels(const std::filesystem::path &file,
                                                const std::vector<const imaging::LabelMap *> &layers,
                                                const imaging::VolumeGeometry &grid, const imaging::DisplacementGrid &u,
                                                const ProgressFn &progress, ThreadPool *threads);
/// That the name has an ending that can be written, and can be written to. Errors: usage, output.
[[nodiscard]] Expected<void> checkImageFile(const std::filesystem::path &file);

}  // namespace c3de::session
