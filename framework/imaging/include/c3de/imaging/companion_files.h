// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "c3de/core/expected.h"
#include "c3de/core/progress.h"

namespace c3de::imaging {

/// Other files that are read with an image or label map: the voxels that a header names, the table of label names
/// beside it, the other files of the series of a DICOM file. Of a folder, or of a file that is no image: none. Any
/// thread. Errors: input, if the header or the folder of a DICOM file cannot be read; cancelled.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> companionFiles(const std::filesystem::path &path,
                                                                          const ProgressFn &progress = {});

}  // namespace c3de::imaging
