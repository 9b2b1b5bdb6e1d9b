// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "app.h"

namespace c3de::app {

/// `c3de` itself, without a window, also where this is the other program; empty: it is not there.
[[nodiscard]] std::filesystem::path consoleProgram();
/// Whether there is one with a window.
[[nodiscard]] bool hasWindowProgram();

/// The program that has a window and draws pictures, beside this one, with the same arguments in its place: `c3de run`
/// stays free of OpenGL and windows until one is asked for. Returns an exit code: that of the other program where it
/// cannot take the place of this one (Windows), or of an error.
[[nodiscard]] int continueInWindowProgram(int argc, char **argv);

}  // namespace c3de::app
