// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"
#include "c3de/imaging/volume.h"

namespace c3de::segmentation {

/// Volume of each label of the map in ml, in its order; 0: it does not occur. Any thread. ErrorCode::cancelled.
[[nodiscard]] Expected<std::vector<double>> volumesOf(const imaging::LabelMap &map, const ProgressFn &progress);

}  // namespace c3de::segmentation
