// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"

namespace c3de::plugin_host {

/// Checks a file before it is passed to the dynamic loader, whose errors are less clear and which may end the process
/// for a truncated library. Checks that it exists, is regular, has the right extension, is a library of this system and
/// processor, and is complete.
[[nodiscard]] Expected<void> checkLibraryFile(const std::filesystem::path &file);

}  // namespace c3de::plugin_host
