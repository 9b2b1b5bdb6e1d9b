// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace c3de {

/// UTF-8 text of a path, and back. Text that is not UTF-8, as of a damaged header, is unchanged on POSIX; on Windows
/// every byte above 127 becomes U+FFFD.
[[nodiscard]] std::string pathText(const std::filesystem::path &path);
[[nodiscard]] std::filesystem::path pathFromText(const std::string &text);

}  // namespace c3de
