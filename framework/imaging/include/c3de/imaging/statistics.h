// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What values an image has; numbers that are not finite do not count.
struct ValueRange {
  double min = 0.0, max = 0.0;
  double low = 0.0, high = 1.0;  ///< without the lowest and highest `clipped` share of the voxels; low < high
};

/// @param clipped  share of the voxels left out at each end, 0 … 0.5; within a 4096th of max - min for other types than
///                 integers of 8 and 16 bits
[[nodiscard]] ValueRange robustRange(const Volume &volume, double clipped = 0.001);

}  // namespace c3de::imaging
