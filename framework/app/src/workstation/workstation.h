// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/session.h"

namespace c3de::app {

struct WorkstationOptions {
  SessionOptions session;                    ///< renderer and registries are set by runWorkstation()
  std::vector<std::filesystem::path> files;  ///< meshes and scenes to open
  std::string meshUnit;                      ///< of meshes passed as files; empty: the unit stated in each file, else
                                             ///< mm
  std::string notice;                        ///< shown in the window at the start; may be empty
  bool isUntitled = false;                   ///< the session in `files` is temporary: saving asks for another file
  bool play = false;                         ///< start playing when the first scene is loaded
  int width = 1280, height = 800;
  std::filesystem::path automationState;  ///< file that mirrors the program's state as JSON; empty: none
};

/// Opens the window and runs until it is closed. Returns the exit code of cli.md.
[[nodiscard]] int runWorkstation(const WorkstationOptions &options);

}  // namespace c3de::app
