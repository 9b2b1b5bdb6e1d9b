// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// Sets the colours of a file in a volume: Volume::colours, and their luma as voxels of 8 bits (Rec. 709, of the
/// encoded colours). Colours of 16 bits are divided by 257.
/// @param numbers  `channels` of them for each voxel, uint8 or uint16
/// @param channels  3, or 4 with opacity
void setColours(Volume &volume, const Voxels &numbers, std::size_t channels);

}  // namespace c3de::imaging
