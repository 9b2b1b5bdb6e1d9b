// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/imaging/volume.h"
#include "formats/label_table.h"

namespace c3de::imaging {

/// Label numbers of an image's voxels.
struct LabelValues {
  std::vector<std::uint16_t> voxels;                ///< i fastest; 0: background
  std::map<std::uint16_t, std::uint64_t> original;  ///< in the file, of those that are renumbered
  std::vector<std::string> notices;                 ///< sentences for a person: what was rounded, replaced, renumbered
};

/// Values that differ from a whole number by at most 0.01 are rounded; what is not finite and one negative value are
/// background; numbers above 65535 get free ones, which `named` does not name. Errors (input): a fraction, several
/// negative values, more than 65535 different labels.
[[nodiscard]] Expected<LabelValues> labelValuesOf(const std::filesystem::path &path, const Volume &volume,
                                                  const LabelTable &named);

}  // namespace c3de::imaging
