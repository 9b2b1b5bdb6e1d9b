// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"
#include "c3de/scene/scene_file.h"
#include "c3de/session/preparation.h"
#include "c3de/session/tissue_places.h"

namespace c3de::session {

class BodySources;

/// Says which labels of its map each tissue of each body is, and what those are that only a name has been said of;
/// makes their parts, and then applies what `--set` has said of these. Reads the label maps. Bodies with labels that
/// slide become several, one for each piece (SceneVolume::cut), with contact between them; what acts on all of such a
/// body acts on its pieces. A scene whose tissues are settled stays as it is. Notices go to the log.
/// @param took  reading is added
/// Errors begin with the place in the scene: a tissue without a label of its own, a name that is not known, labels of
/// different tissues under one name, nothing that can move, what slides and is no label, rigid or empty, those of
/// readers and overrides. Any thread.
[[nodiscard]] Expected<void> settleTissues(scene::SceneFile &scene, const scene::MaterialLibrary &materials,
                                           BodySources &sources, const ProgressFn &progress, Preparation &took);

/// Which voxels of a label map are which tissue of a body: on the grid of the labels 1 and the number of the tissue in
/// SceneVolume::tissues, or 1 and their count for the background; 0: not of the body. Where labels of several layers
/// lie over each other the last one with a tissue counts. What has no tissue is of the background: labels whatever the
/// image shows there; other voxels, and those of empty tissues, where it is between its limits (at the voxel of the
/// image that their middle lies in). Without a background that is not of the body.
/// @param volume  settled
/// @param image    of the background; null: there is none
/// @param notices  sentences are added: what of the background is taken for empty, or that there is none
/// Errors: layers of different grids, an image beside the map, cancelled. Any thread.
[[nodiscard]] Expected<imaging::LabelMap> pickTissues(const scene::SceneVolume &volume,
                                                      const std::vector<imaging::LabelMap> &layers,
                                                      const imaging::Volume *image, const ProgressFn &progress,
                                                      std::vector<std::string> *notices = nullptr);

/// About how thick each tissue is, mm: the diameter of a tube of its volume and surface, which makes balls thinner and
/// sheets thicker than they are. 0: it has no voxel.
/// @param picked  pickTissues()
[[nodiscard]] std::vector<double> thicknessOf(const imaging::LabelMap &picked, std::size_t tissues);

/// The labels of a body of many tissues: where they are.
/// @param picked  pickTissues() of the same layers, without voxels that are not of the body
[[nodiscard]] TissuePlaces tissuePlaces(const scene::SceneBody &body, const std::vector<imaging::LabelMap> &layers,
                                        const imaging::LabelMap &picked);

}  // namespace c3de::session
