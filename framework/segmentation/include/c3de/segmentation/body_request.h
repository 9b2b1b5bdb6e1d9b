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

/// How a body is held.
enum class Held {
  surroundings,  ///< elastically at its position in the scan, by the surrounding tissue
  lowestPart,    ///< its lowest part along gravity is fixed
  nothing
};
/// Stiffness of the tissue around an organ, Pa/m. With it an organ moves some millimetres when the patient turns over,
/// as scans show.
inline constexpr double kSurroundingsStiffness = 3e4;

/// A mask, or a label of a label map, from which a body is to be created.
struct BodyRequest {
  std::string name;
  std::shared_ptr<const imaging::Mask> mask;          ///< null: the label as it is in `labels`
  std::shared_ptr<const scene::StoredLabels> labels;  ///< source of the label; null: no label
  std::uint16_t label = 0;
  imaging::MaskCleanUp mend;  ///< of the label
  std::string material;       ///< name of a preset
  std::size_t points = 0;     ///< target count; 0: by the thickness
  double edge_mm = 0.0;       ///< of the surface; 0: automatic
  Held held = Held::surroundings;
  double surroundings_Pa_m = kSurroundingsStiffness;  ///< stress per displacement, where the surroundings hold it
  bool isRigid = false;                               ///< fixed at its position in the scan; costs nothing
};

/// The voxels of the body. Any thread. ErrorCode::usage: there are none; cancelled.
[[nodiscard]] Expected<imaging::Mask> maskOf(const BodyRequest &request, const ProgressFn &progress = {});

}  // namespace c3de::segmentation
