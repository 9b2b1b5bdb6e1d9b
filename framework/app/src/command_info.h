// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/session/session.h"

namespace c3de::app {

struct InfoOptions {
  SessionOptions session;
  std::vector<std::filesystem::path> files;
  std::string meshUnit;       ///< of meshes; empty: what the file says, else mm
  std::string series;         ///< of a folder of images with several; empty: the only one, or a list of them
  std::size_t time = 0;       ///< of images of several time points
  bool patientNames = false;  ///< whether the names of patients are shown
  bool isQuick = false;       ///< bodies of scenes are not built: what only that can tell is not checked
  bool json = false;          ///< one file: an object; several: a list of objects
};

/// `c3de info`: what each file contains and what is wrong with it, on stdout; goes on after a file that is refused.
/// Returns the exit code.
[[nodiscard]] int showInfo(const InfoOptions &options);

}  // namespace c3de::app
