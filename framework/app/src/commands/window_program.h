// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "app.h"

namespace c3de::app {

/// Path of `c3de`, the program without a window, also when called from the other program; empty if it does not exist.
[[nodiscard]] std::filesystem::path consoleProgram();
/// Whether a program with a window exists.
[[nodiscard]] bool hasWindowProgram();

/// Continues as the program that has a window and draws pictures, in the same folder, with the same arguments. Before
/// that, `c3de run` needs neither OpenGL nor windows. Returns an exit code: that of the other program where it cannot
/// replace this process (Windows), or of an error.
[[nodiscard]] int continueInWindowProgram(int argc, char **argv);

}  // namespace c3de::app
