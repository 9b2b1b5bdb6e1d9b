// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::app {

/// Whether a file can be written there, asked before hours of work go into what is to be written. Leaves an existing file
/// as it is and no new one behind. The error (ErrorCode::output) says why not.
[[nodiscard]] Expected<void> checkWritable(const std::filesystem::path &file);

/// That no output takes the place of a file that is read (a scan has no second copy), nor of another output. Empty paths
/// are left out. The error (ErrorCode::usage) names both.
[[nodiscard]] Expected<void> checkDistinct(std::span<const std::filesystem::path> outputs, std::span<const std::filesystem::path> inputs);

[[nodiscard]] Expected<void> writeTextFile(const std::filesystem::path &file, std::string_view text);

}  // namespace c3de::app
