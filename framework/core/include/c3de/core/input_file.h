// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "c3de/core/expected.h"

namespace c3de {

/// What a path leads to instead of a regular file: "is a pipe (FIFO), not a file"; empty for a file. Symbolic links are
/// followed.
[[nodiscard]] std::string whatInsteadOfFile(const std::filesystem::path &path);

/// Refuses what is no regular file, with "PATH: what it is instead". Pipes, sockets and devices are never opened:
/// reading them can block or never end.
[[nodiscard]] Expected<void> checkInputFile(const std::filesystem::path &path);

/// Opens a regular file for reading, without conversion of line ends. Errors (input): those of checkInputFile(), no
/// permission.
[[nodiscard]] Expected<std::ifstream> openInputFile(const std::filesystem::path &path);

/// `name` as a header in `folder` names a file. Of a name with backslashes that is no file here the same with slashes
/// is taken where that is one: headers written on Windows.
[[nodiscard]] std::filesystem::path namedFile(const std::filesystem::path &folder, const std::string &name);

}  // namespace c3de
