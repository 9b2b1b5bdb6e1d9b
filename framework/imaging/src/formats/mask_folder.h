// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/imaging/reading.h"

namespace c3de::imaging {

/// Files of images that lie in a folder, by name; none where it is no folder or holds DICOM.
[[nodiscard]] std::vector<std::filesystem::path> maskFilesIn(const std::filesystem::path &folder);

/// A folder of masks, one file for each label: numbered from 1 in the order of their names, which they are called by.
/// Those that share voxels lie in layers, as few as they need. Errors name the file: no mask, another grid than the
/// first one, those of readers.
[[nodiscard]] Expected<LoadedLabels> readMaskFolder(const std::filesystem::path &folder,
                                                    const std::vector<std::filesystem::path> &files,
                                                    const ReadOptions &options);

}  // namespace c3de::imaging
