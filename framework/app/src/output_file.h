// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "c3de/core/expected.h"

namespace c3de::app {

/// Whether a file can be written there, asked before hours of work go into what is to be written. Leaves an existing file
/// as it is and no new one behind. The error (ErrorCode::output) says why not.
[[nodiscard]] Expected<void> checkWritable(const std::filesystem::path &file);

[[nodiscard]] Expected<void> writeTextFile(const std::filesystem::path &file, std::string_view text);

}  // namespace c3de::app
