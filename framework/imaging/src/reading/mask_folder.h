// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/imaging/reading.h"

namespace c3de::imaging {

/// Image files in a folder, sorted by name; empty where it is not a folder or contains DICOM.
[[nodiscard]] std::vector<std::filesystem::path> maskFilesIn(const std::filesystem::path &folder);

/// A folder of masks, one file for each label: numbered from 1 in the order of their names, which become the label
/// names. Masks that share voxels are stored in as few layers as possible. Errors name the file: not a mask, another
/// grid than the first one, those of readers.
[[nodiscard]] Expected<LoadedLabels> readMaskFolder(const std::filesystem::path &folder,
                                                    const std::vector<std::filesystem::path> &files,
                                                    const ReadOptions &options);

}  // namespace c3de::imaging
