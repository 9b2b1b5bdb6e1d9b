// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"
#include "c3de/scene/scene_file.h"

namespace c3de::session {

/// Which voxels of a label map are which tissue of a body.
struct PickedTissues {
  /// On the grid of the labels: 1 and the number of the tissue in SceneVolume::tissues, or `background`; 0: not of the
  /// body
  imaging::LabelMap voxels;
  std::uint16_t background = 0;
  std::vector<std::string> notices;  ///< what nobody has said anything about, for people
};

/// Labels are of the first tissue that names them; of several layers the last one with a tissue counts. What has no
/// tissue is of the background: labels whatever the image shows there, other voxels where it is between its limits (at
/// the voxel of the image that their middle lies in). Without a background that is not of the body.
/// @param image  of the background; null: there is none
/// Errors: a tissue that names no label, nothing left. Any thread.
[[nodiscard]] Expected<PickedTissues> pickTissues(const scene::SceneVolume &volume,
                                                  const std::vector<imaging::LabelMap> &layers,
                                                  const imaging::Volume *image, const ProgressFn &progress);

}  // namespace c3de::session
