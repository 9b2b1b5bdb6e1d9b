// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "c3de/imaging/volume.h"

namespace c3de::imaging {

/// A readable form: "kidney_left" -> "kidney left"; a single vertebra in the singular: "vertebrae_T12" -> "vertebra
/// T12".
[[nodiscard]] std::string readableName(std::string_view name);

/// The name of the only label of a map, from its file name: "heart.nii.gz" -> "heart", "liver_mask.nrrd" -> "liver".
/// Empty where the file name only says that it is a label map.
[[nodiscard]] std::string nameFromFile(const std::filesystem::path &file);

/// Whether a text denotes a label: its name, with '*' for any text, or its number.
[[nodiscard]] bool matchesLabel(std::string_view wanted, const LabelMap::Label &label);

/// Linear RGB for the n-th label without an own colour; any two of the first dozens are distinguishable.
[[nodiscard]] std::array<float, 3> distinctColour(std::size_t n);

}  // namespace c3de::imaging
