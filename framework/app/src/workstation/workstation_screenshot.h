// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"

namespace c3de::app {

/// Writes the content of a PNG file to `out/c3de-DATE-TIME.png` in the current folder, or in the user's data folder if
/// that is not writable. Returns the file. Any thread.
[[nodiscard]] Expected<std::filesystem::path> writeScreenshotFile(const std::vector<char> &bytes);

}  // namespace c3de::app
