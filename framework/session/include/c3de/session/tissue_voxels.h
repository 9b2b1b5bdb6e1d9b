// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/core/vec.h"
#include "c3de/imaging/masks.h"
#include "c3de/imaging/volume.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// The voxels of a label in a body's map, mm in the scan.
struct LabelVoxels {
  std::string name;               ///< empty: the background without a label
  std::uint16_t value = 0;        ///< 0: no label
  std::size_t tissue = 0;         ///< index in SceneVolume::tissues; their count: the background
  std::size_t voxels = 0;         ///< that belong to the body
  std::array<float, 3> colour{};  ///< linear RGB, as displayed in its map
  std::vector<Vec3> sample;       ///< evenly spaced voxel centres; all of a small label
};

/// The labels of a body of many tissues, in the order of its tissues and of the map, including labels without a voxel.
struct TissueVoxels {
  std::string body;
  std::vector<scene::SceneTissue> tissues;
  scene::ScenePlacement placement;
  double voxel_mm3 = 0.0;
  std::vector<LabelVoxels> labels;
  std::shared_ptr<const imaging::LabelMap> map;  ///< pickTissues(), in the frame of the scan

  /// The tissue of LabelVoxels::tissue; for the background a tissue of that name.
  [[nodiscard]] scene::SceneTissue tissueAt(std::size_t number) const {
    if (number < tissues.size()) return tissues[number];
    scene::SceneTissue background;
    background.label = "background";
    return background;
  }
};

/// For each value of a layer: 1 plus the index of its tissue, or of the background; 0: none.
[[nodiscard]] std::vector<std::uint16_t> tissueNumbers(const scene::SceneVolume &volume, const imaging::LabelMap &map,
                                                       std::size_t layer);

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

/// Marks the tissues of bodies at rest as imaging::kBodyVoxel and kRigidVoxel, voxel by voxel. A skin would only be as
/// accurate as its edge length. Any thread.
void markTissues(const std::vector<TissueVoxels> &bodies, imaging::Mask &places);

}  // namespace c3de::session
