// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "c3de/scene/materials.h"

namespace c3de::scene {

/// The preset to start from for what a label map calls an organ: "kidney_left", "Left Kidney" -> kidney_cortex,
/// "vertebrae_L1" -> bone_cortical. By whole words, upper and lower case alike; a preset's own name is taken as it is.
/// What has a word of its own in the name (tumour, cyst, vein, …) does not get the organ's. Null: none fits.
[[nodiscard]] const MaterialPreset *presetForOrgan(const MaterialLibrary &materials, std::string_view organ);

}  // namespace c3de::scene
