// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// The value range of an image; non-finite values are ignored.
struct ValueRange {
  double min = 0.0, max = 0.0;
  double low = 0.0, high = 1.0;  ///< display window; low < high
};

/// Whether values are those of computed tomography: in HU by the file, or ranging from air at -1000 upwards with a peak
/// of soft tissue around 0. At most one value may be below -1100, which fills the region outside the field of view.
[[nodiscard]] bool isLikelyHounsfield(const Volume &volume);

/// The display window. For computed tomography, soft tissue up to bone: from the 1st percentile of everything except
/// air and lung (above -300 HU, not below -200) to its 98th percentile without metal (below 2000 HU; 250 to 1000). For
/// colours the full range, 0 to 255. Otherwise all but the lowest and highest `clipped` fraction of the voxels.
/// @param clipped  fraction of the voxels excluded at each end, 0 … 0.5; accurate to a 4096th of max - min for types
///                 other than integers of 8 and 16 bits
[[nodiscard]] ValueRange robustRange(const Volume &volume, double clipped = 0.001);

/// Number of voxels with values in `bins` equal intervals from `low` to `high`, which belongs to the last one; others, and
/// values that are not finite, are left out. Empty if low >= high or bins == 0. Any thread.
[[nodiscard]] std::vector<std::uint64_t> histogramOf(const Volume &volume, double low, double high, std::size_t bins);

}  // namespace c3de::imaging
