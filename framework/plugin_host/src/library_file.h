// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"

namespace c3de::plugin_host {

/// What can be said about a file before it is given to the dynamic loader, which answers less clearly and, for a
/// truncated library, may end the process: exists, regular, right ending, a library of this system and processor,
/// complete.
[[nodiscard]] Expected<void> checkLibraryFile(const std::filesystem::path &file);

}  // namespace c3de::plugin_host
