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
  std::map<std::uint16_t, std::uint64_t> original;  ///< number in the file, for renumbered labels
  std::vector<std::string> notices;                 ///< sentences for the user: what was rounded, replaced, renumbered
};

/// Values that differ from an integer by at most 0.01 are rounded; non-finite values and one negative value are
/// background; numbers above 65535 get free ones that `named` does not contain. Errors (input): a fraction, several
/// negative values, more than 65535 different labels.
[[nodiscard]] Expected<LabelValues> labelValuesOf(const std::filesystem::path &path, const Volume &volume,
                                                  const LabelTable &named);

}  // namespace c3de::imaging
