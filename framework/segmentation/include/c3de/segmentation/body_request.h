// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/masks.h"
#include "c3de/scene/image_store.h"

namespace c3de::segmentation {

/// What holds a body.
enum class Held {
  surroundings,  ///< elastically, where it is in the scan: the tissue around
  lowestPart,    ///< what lies lowest, along gravity, stands still
  nothing
};
/// Of the tissue around an organ, Pa/m: by so much that it moves some millimetres when its owner turns over, as scans
/// show.
inline constexpr double kSurroundingsStiffness = 3e4;

/// What is to become a body: a mask, or a label of a label map.
struct BodyRequest {
  std::string name;
  std::shared_ptr<const imaging::Mask> mask;          ///< null: the label as it is in `labels`
  std::shared_ptr<const scene::StoredLabels> labels;  ///< that it comes from; null: no label
  std::uint16_t label = 0;
  imaging::Mending mend;   ///< of the label
  std::string material;    ///< name of a preset
  std::size_t points = 0;  ///< wanted; 0: by the thickness
  double edge_mm = 0.0;    ///< of the surface; 0: automatic
  Held held = Held::surroundings;
  double surroundings_Pa_m = kSurroundingsStiffness;  ///< stress per way, where the surroundings hold it
  bool isRigid = false;                               ///< it stands where it is in the scan and costs nothing
};

/// The voxels of the body. Any thread. ErrorCode::usage: there are none; cancelled.
[[nodiscard]] Expected<imaging::Mask> maskOf(const BodyRequest &request, const ProgressFn &progress = {});

}  // namespace c3de::segmentation
