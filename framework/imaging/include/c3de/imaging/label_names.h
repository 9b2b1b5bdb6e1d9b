// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// As a person writes it: "kidney_left" -> "kidney left"; one vertebra is a vertebra: "vertebrae_T12" -> "vertebra
/// T12".
[[nodiscard]] std::string readableName(std::string_view name);

/// What a label map of one label shows, by the name of its file: "heart.nii.gz" -> "heart", "liver_mask.nrrd" ->
/// "liver". Empty where the name says only that it is a label map.
[[nodiscard]] std::string nameFromFile(const std::filesystem::path &file);

/// Whether a text means a label: its name, with '*' for any text, or its number.
[[nodiscard]] bool isMeant(std::string_view wanted, const LabelMap::Label &label);

/// Linear RGB for the n-th label that has no colour of its own; any two of the first dozens look different.
[[nodiscard]] std::array<float, 3> distinctColour(std::size_t n);

}  // namespace c3de::imaging
