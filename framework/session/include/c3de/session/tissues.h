// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/preparation.h"
#include "c3de/session/tissue_voxels.h"

namespace c3de::session {

class BodySources;

/// Resolves which labels of its map each tissue of each body has, and the properties of tissues specified only by name.
/// Creates their parts, and then applies the `--set` overrides for them. Reads the label maps. Bodies with sliding
/// labels become several, one for each piece (SceneVolume::cut), with contact between them; whatever acts on the whole
/// body acts on its pieces. A scene whose tissues are resolved stays unchanged. Notices go to the log.
/// @param took  the reading time is added
/// Errors begin with the location in the scene: a tissue without a label of its own, an unknown name, labels of
/// different tissues under one name, nothing that can move, a sliding name that is no label, rigid or empty, those of
/// readers and overrides. Any thread.
[[nodiscard]] Expected<void> resolveTissues(scene::SceneFile &scene, const scene::MaterialLibrary &materials,
                                            BodySources &sources, const ProgressFn &progress, Preparation &took);

/// The tissue of each voxel of a body, on the grid of the labels: 1 plus the index in SceneVolume::tissues, or 1 plus
/// their count for the background; 0: not part of the body. Where labels of several layers overlap, the last layer with
/// a tissue counts. Voxels without a tissue belong to the background: labelled ones whatever the image shows there;
/// others, and those of empty tissues, where the image value is within the background's limits (image voxel that
/// contains their centre). Without a background they are not part of the body.
/// @param volume  with resolved tissues
/// @param image    of the background; null: there is none
/// @param notices  sentences are added: which background voxels are treated as empty, or that there is no background
/// Errors: layers of different grids, an image that does not overlap the map, cancelled. Any thread.
[[nodiscard]] Expected<imaging::LabelMap> pickTissues(const scene::SceneVolume &volume,
                                                      const std::vector<imaging::LabelMap> &layers,
                                                      const imaging::Volume *image, const ProgressFn &progress,
                                                      std::vector<std::string> *notices = nullptr);

/// Approximate thickness of each tissue, mm: the diameter of a tube of the same volume and surface, which
/// underestimates balls and overestimates sheets. 0: it has no voxel.
/// @param picked  pickTissues()
[[nodiscard]] std::vector<double> thicknessOf(const imaging::LabelMap &picked, std::size_t tissues);

/// Where the labels of a body of many tissues are located.
/// @param picked  pickTissues() of the same layers, without voxels outside the body
[[nodiscard]] TissueVoxels tissuePlaces(const scene::SceneBody &body, const std::vector<imaging::LabelMap> &layers,
                                        const imaging::LabelMap &picked);

}  // namespace c3de::session
