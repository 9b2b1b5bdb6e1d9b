// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "c3de/core/expected.h"

namespace c3de {

/// Description of a path that is not a regular file: "is a pipe (FIFO), not a file"; empty for a file. Symbolic links
/// are followed.
[[nodiscard]] std::string describeNonFile(const std::filesystem::path &path);

/// Refuses anything but a regular file, with "PATH: " and its type. Pipes, sockets and devices are never opened:
/// reading them can block or never end.
[[nodiscard]] Expected<void> checkInputFile(const std::filesystem::path &path);

/// Opens a regular file for reading, without conversion of line ends. Errors (input): those of checkInputFile(), no
/// permission.
[[nodiscard]] Expected<std::ifstream> openInputFile(const std::filesystem::path &path);

/// The file named `name` in a header in `folder`. If that does not exist and the name has backslashes, the same name
/// with slashes is used if it exists: for headers written on Windows.
[[nodiscard]] std::filesystem::path namedFile(const std::filesystem::path &folder, const std::string &name);

}  // namespace c3de
