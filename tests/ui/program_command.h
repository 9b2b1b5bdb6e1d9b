// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace c3de::test {

/// The command that runs the program, without a window, on these arguments: that of this build, or with
/// C3DE_WINDOWS_BUILD (a build for Windows) and C3DE_WINE (the script that starts wine) in the environment that one.
std::vector<std::string> programCommand(const std::vector<std::string> &arguments);

/// A file that the program names, as this process finds it.
std::filesystem::path fileOfProgram(const std::string &name);

/// The full path by which the program finds a file or folder of this process.
std::string nameInProgram(const std::filesystem::path &file);

}  // namespace c3de::test
