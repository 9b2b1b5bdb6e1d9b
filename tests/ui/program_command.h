// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace c3de::test {

/// The command that runs the program, without a window, on these arguments: that of this build, or with C3DE_WINDOWS_BUILD (a
/// build for Windows) and C3DE_WINE (the script that starts wine) in the environment that one.
std::vector<std::string> programCommand(const std::vector<std::string> &arguments);

/// A file that the program names, as this process finds it.
std::filesystem::path fileOfProgram(const std::string &name);

}  // namespace c3de::test
