// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/session/session_file.h"
#include "commands/info_image.h"

namespace c3de::app {

/// The files of a session or recording, one a line, with their states. @param list  receives the same
[[nodiscard]] Expected<std::string> describeFiles(const SessionFile &saved, const std::filesystem::path &file,
                                                  const std::vector<std::filesystem::path> &search,
                                                  nlohmann::ordered_json &list);
/// What a recording begins with, what happened in it, whether it is complete, and its files.
[[nodiscard]] Expected<Described> describeRecording(const std::filesystem::path &file,
                                                    const std::vector<std::filesystem::path> &search);

}  // namespace c3de::app
