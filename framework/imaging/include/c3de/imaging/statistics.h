// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// What values an image has; numbers that are not finite do not count.
struct ValueRange {
  double min = 0.0, max = 0.0;
  double low = 0.0, high = 1.0;  ///< of what one wants to see; low < high
};

/// Whether values are those of computed tomography: in HU by the file, or from air at -1000 up with a peak of soft
/// tissue around 0; what lies below -1100 is at most one value, which fills the field outside of the scanner's.
[[nodiscard]] bool looksLikeHounsfield(const Volume &volume);

/// What is seen is, for computed tomography, soft tissue up to bone: from the lowest hundredth of what is neither air
/// nor lung (above -300 HU, not below -200) to the highest fiftieth of it without metal (below 2000 HU; 250 to 1000).
/// Of colours all, 0 to 255. Else all but the lowest and highest `clipped` share of the voxels.
/// @param clipped  share of the voxels left out at each end, 0 … 0.5; within a 4096th of max - min for other types than
///                 integers of 8 and 16 bits
[[nodiscard]] ValueRange robustRange(const Volume &volume, double clipped = 0.001);

}  // namespace c3de::imaging
