// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"

namespace c3de::ui {

/// The guide that belongs to the program in this folder: the site of an installation or of the build, otherwise the
/// pages themselves. Empty: neither is there.
[[nodiscard]] std::filesystem::path findGuide(const std::filesystem::path &programFolder);

/// Starts the user's browser, or the program for such files, and does not wait for it.
/// @return the file. Errors: no file; nothing on this computer opens files
[[nodiscard]] Expected<std::filesystem::path> showInBrowser(const std::filesystem::path &file);

}  // namespace c3de::ui
