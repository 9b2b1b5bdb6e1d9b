// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "c3de/core/vec.h"
#include "c3de/imaging/volume.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// Where a label of a body's map has its voxels, mm in the scan.
struct LabelPlaces {
  std::string name;               ///< empty: the background without a label
  std::uint16_t value = 0;        ///< 0: no label
  std::size_t tissue = 0;         ///< in SceneVolume::tissues; their count: the background
  std::size_t voxels = 0;         ///< that are of the body
  std::array<float, 3> colour{};  ///< linear RGB, as its map shows it
  std::vector<Vec3> sample;       ///< middles of some of them, evenly in the order of voxels; all of a small label
};

/// The labels of a body of many tissues, in the order of its tissues and of the map, those without a voxel too.
struct TissuePlaces {
  std::string body;
  std::vector<scene::SceneTissue> tissues;
  scene::ScenePlacement placement;
  double voxel_mm3 = 0.0;
  std::vector<LabelPlaces> labels;
  std::shared_ptr<const imaging::LabelMap> map;  ///< pickTissues(), where the scan is

  /// That of LabelPlaces::tissue, of the background one of that name.
  [[nodiscard]] scene::SceneTissue tissueAt(std::size_t number) const {
    if (number < tissues.size()) return tissues[number];
    scene::SceneTissue background;
    background.label = "background";
    return background;
  }
};

/// Marks where the tissues of bodies are at rest, as imaging::kBodyVoxel and kRigidVoxel: voxel by voxel, where a skin
/// is as coarse as its edges. Any thread.
void markTissues(const std::vector<TissuePlaces> &bodies, imaging::Mask &places);

}  // namespace c3de::session
