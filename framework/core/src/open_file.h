// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>

namespace c3de::detail {

enum class OpenMode { replace, createNew, append };

/// Binary; null with errno set when it cannot be opened. createNew fails where there is a file.
[[nodiscard]] std::FILE *openFile(const std::filesystem::path &path, OpenMode mode);

/// A new file in a folder that has no name yet, for writing: the system takes it back when the program ends, however it
/// ends. Null where the system or the folder's disk knows no such files.
[[nodiscard]] std::FILE *openUnnamed(const std::filesystem::path &folder);
/// Gives such a file a name that no file has. @return errno, 0: done
[[nodiscard]] int nameFile(std::FILE *file, const std::filesystem::path &path);

}  // namespace c3de::detail
