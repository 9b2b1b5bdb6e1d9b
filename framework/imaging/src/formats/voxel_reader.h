// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "c3de/imaging/reading.h"
#include "formats/image_header.h"

namespace c3de::imaging {

/// The voxels of the volume that a header and options.time select. @param notices  assumptions are added
[[nodiscard]] Expected<Voxels> readVoxels(const ImageHeader &header, const ReadOptions &options,
                                          std::vector<std::string> &notices);

/// Refuses to read if more memory than the limit is needed (0: the free memory of the machine); the message states
/// both.
[[nodiscard]] Expected<void> checkMemory(const std::filesystem::path &path, double bytes, std::size_t limit);

/// Whether to continue; true without a function.
[[nodiscard]] bool shouldContinue(const ProgressFn &progress, double fraction, const std::string &what);
[[nodiscard]] tl::unexpected<Error> cancelled(const std::filesystem::path &path);

}  // namespace c3de::imaging
