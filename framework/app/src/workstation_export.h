// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "session.h"

namespace c3de::app {

/// Told on the main thread: the files that were written, one a line, or why not.
using ExportTold = std::function<void(const Expected<std::string> &)>;

/// Writes the skins of the present state (surfaceFiles() says under which names), between two steps on the simulation's
/// thread, so that all of it is one moment. Nothing without a simulation. Main thread.
void exportPresentSurface(Session &session, const std::filesystem::path &file, ExportTold told);
/// The same as a sequence of one frame: FILE.pvd and its folder.
void exportPresentFrame(Session &session, const std::filesystem::path &file, ExportTold told);

}  // namespace c3de::app
