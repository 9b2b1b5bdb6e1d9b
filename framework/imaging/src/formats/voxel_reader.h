// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/reading.h"
#include "formats/image_header.h"

namespace c3de::imaging {

/// The voxels of the first volume that a header describes. @param notices  gets what was assumed
[[nodiscard]] Expected<Voxels> readVoxels(const ImageHeader &header, const ReadOptions &options,
                                          std::vector<std::string> &notices);

/// Refuses what needs more than the limit (0: than the machine has free); the message names both.
[[nodiscard]] Expected<void> checkMemory(const std::filesystem::path &path, double bytes, std::size_t limit);

/// Whether to go on; a missing function says yes.
[[nodiscard]] bool shouldContinue(const ProgressFn &progress, double fraction, const std::string &what);
[[nodiscard]] tl::unexpected<Error> cancelled(const std::filesystem::path &path);

}  // namespace c3de::imaging
