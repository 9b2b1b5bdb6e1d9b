// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>

namespace c3de::detail {

enum class OpenMode { replace, createNew, append };

/// Binary; null with errno set if it cannot be opened. createNew fails if the file exists.
[[nodiscard]] std::FILE *openFile(const std::filesystem::path &path, OpenMode mode);

/// A new unnamed file in a folder, for writing; the system removes it when the program ends, for whatever reason. Null
/// if the system or the file system does not support such files.
[[nodiscard]] std::FILE *openUnnamed(const std::filesystem::path &folder);
/// Gives such a file a name that is not in use. @return errno, 0: success
[[nodiscard]] int nameFile(std::FILE *file, const std::filesystem::path &path);

/// Returns when what was flushed is on the disk. Devices without one are left out. @return errno, 0: success
[[nodiscard]] int syncFile(std::FILE *file);
/// The same for the names in a folder, as far as the system can.
void syncFolder(const std::filesystem::path &folder);

}  // namespace c3de::detail
