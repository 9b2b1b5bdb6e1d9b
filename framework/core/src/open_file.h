// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>

namespace c3de::detail {

enum class OpenMode { replace, createNew, append };

/// Binary; null with errno set when it cannot be opened. createNew fails where there is a file.
[[nodiscard]] std::FILE *openFile(const std::filesystem::path &path, OpenMode mode);

}  // namespace c3de::detail
