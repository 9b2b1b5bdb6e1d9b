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

/// The files of a session or recording, one a line, with their states; then folders that could not be searched.
/// @param json  receives the same as `files` and `unread_folders`
[[nodiscard]] Expected<std::string> describeFiles(const SessionFile &saved, const std::filesystem::path &file,
                                                  const std::vector<std::filesystem::path> &search,
                                                  nlohmann::ordered_json &json);
/// What a recording begins with, what happened in it, whether it is complete, and its files.
[[nodiscard]] Expected<Described> describeRecording(const std::filesystem::path &file,
                                                    const std::vector<std::filesystem::path> &search);

}  // namespace c3de::app
