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

/// Marks the tissues of bodies at rest as imaging::kBodyVoxel and kRigidVoxel, voxel by voxel. A skin would only be as
/// accurate as its edge length. Any thread.
void markTissues(const std::vector<TissueVoxels> &bodies, imaging::Mask &places);

}  // namespace c3de::session
