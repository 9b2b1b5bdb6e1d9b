// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace c3de {

/// UTF-8 text of a path, and back.
[[nodiscard]] std::string pathText(const std::filesystem::path &path);
[[nodiscard]] std::filesystem::path pathFromText(const std::string &text);

}  // namespace c3de
