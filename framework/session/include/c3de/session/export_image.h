// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "c3de/abi/iface/simulator.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/displacement.h"
#include "c3de/imaging/fixed_regions.h"
#include "c3de/imaging/reading.h"
#include "c3de/scene/materials.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de {
class ThreadPool;
}

namespace c3de::session {

class BodySources;

/// The outputs of the deformed scan; an empty path means not requested. NRRD, NIfTI or MetaImage, by extension.
struct ImageExport {
  /// The scene's image deformed with the tissue, on its own grid and in its own type
  std::filesystem::path image;
  /// u(x) in mm at the image's voxels (x, y, z in LPS): the material at x was at x - u. emptiedFile() is written as
  /// well.
  std::filesystem::path displacement;
  /// The deformed label map, on the grid of the image; labelFiles() lists the files written
  std::filesystem::path labels;
  [[nodiscard]] bool isWanted() const { return !image.empty() || !displacement.empty() || !labels.empty(); }
};

/// How an image is deformed with the bodies.
struct ImageWarp {
  double rim_mm = 10.0;                                        ///< around the bodies, until their displacement is zero
  imaging::FixedRegionRule still;                              ///< regions that stay fixed
  std::shared_ptr<const imaging::LabelMap> labels;             ///< the labels that `still` refers to; may be null
  std::shared_ptr<const std::vector<TissueVoxels>> tissues{};  ///< of the bodies of many tissues; null: there are none
};
/// The warp of a scene. Reads its image and labels unless they were read before. Errors: those of reading and of
/// fixedRegionRuleOf(), with the line of [image].
/// @param tissues  of its bodies; empty: not created yet
[[nodiscard]] Expected<ImageWarp> imageWarpOf(const scene::SceneFile &scene, BodySources &sources,
                                              const scene::MaterialLibrary &materials,
                                              const std::vector<TissueVoxels> &tissues = {});

/// The image of a scene that has one. Errors: those of reading, with the line of [image].
[[nodiscard]] Expected<std::shared_ptr<const imaging::Volume>> imageOfScene(const scene::SceneFile &scene,
                                                                            BodySources &sources);

/// Checks before the simulation begins that there is an image to provide the grid, and that the files can be written.
/// Errors: usage, output.
[[nodiscard]] Expected<void> checkImageExport(const ImageExport &wanted, const scene::SceneFile &scene);
/// The displacement of the tissue wherever bodies are in the image, on a finer grid than the live display. [sim]
[[nodiscard]] Expected<imaging::DisplacementGrid> presentDisplacement(const c3de_simulator_v1 *table,
                                                                      c3de_object *simulator,
                                                                      const imaging::Volume &image,
                                                                      const ImageWarp &how);
/// u.nrrd -> u-vacated.nrrd: 1 where a body has moved away and the present content is unknown. The field itself has no
/// mark: it stays finite, as programs that resample with it require.
[[nodiscard]] std::filesystem::path emptiedFile(const std::filesystem::path &displacement);
/// Whether the voxel values of the scene's image are label numbers: it is one of the scene's label maps, or a body is
/// made from its labels.
[[nodiscard]] bool isImageOfLabels(const scene::SceneFile &scene);
/// The layers of the exported label map: the last one of [image], otherwise that of the first body with labels. Errors:
/// those of reading, and that there is none.
[[nodiscard]] Expected<std::shared_ptr<const std::vector<imaging::LabelMap>>> labelsToExport(
    const scene::SceneFile &scene, BodySources &sources);
/// a.nrrd, a-2.nrrd, …: one file per layer.
[[nodiscard]] std::vector<std::filesystem::path> labelFiles(const std::filesystem::path &labels, std::size_t layers);
/// The image as writeImages() writes it: nearest-neighbour sampling of label numbers, linear interpolation otherwise.
/// Any thread. @param threads  null: the calling thread only
[[nodiscard]] Expected<imaging::Volume> warpedImage(const imaging::Volume &image, bool areLabels,
                                                    const imaging::DisplacementGrid &u, const ProgressFn &progress,
                                                    ThreadPool *threads);
/// Warps and writes image and displacement. Any thread. Returns a text for the user: the files, and how much of the
/// image is vacated.
/// @param areLabels  the voxel values are label numbers: nearest-neighbour sampling, no interpolation
/// @param threads    null: the calling thread only
[[nodiscard]] Expected<std::string> writeImages(const ImageExport &wanted, const imaging::Volume &image, bool areLabels,
                                                const imaging::DisplacementGrid &u, const ProgressFn &progress,
                                                ThreadPool *threads);
/// Same for the label map: the nearest label at each voxel of the image.
/// @param layers  from labelsToExport()
/// @param grid    of the image
[[nodiscard]] Expected<std::string> writeLabels(const std::filesystem::path &file,
                                                const std::vector<const imaging::LabelMap *> &layers,
                                                const imaging::VolumeGeometry &grid, const imaging::DisplacementGrid &u,
                                                const ProgressFn &progress, ThreadPool *threads);
/// Checks that the file has a supported extension and can be written. Errors: usage, output.
[[nodiscard]] Expected<void> checkImageFile(const std::filesystem::path &file);

}  // namespace c3de::session
