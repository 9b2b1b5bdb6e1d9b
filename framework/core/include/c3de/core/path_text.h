// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace c3de {

/// UTF-8 text of a path, and back. Text that is not UTF-8, as of a damaged header: the same bytes, or on Windows, whose
/// paths have none, U+FFFD for each above 127.
[[nodiscard]] std::string pathText(const std::filesystem::path &path);
[[nodiscard]] std::filesystem::path pathFromText(const std::string &text);

}  // namespace c3de
