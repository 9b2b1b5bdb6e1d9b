// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/reading.h"

namespace c3de::app {

/// What is said about one file, for people and for programs.
struct Described {
  std::string text;
  nlohmann::ordered_json json;
};

/// Says what an image file or a folder of images holds. A folder with several series is a list of them until one is
/// chosen.
/// @param options       series and time point
/// @param patientNames  whether the names of patients are shown
[[nodiscard]] Expected<Described> describeImage(const std::filesystem::path &path, const imaging::ReadOptions &options,
                                                bool patientNames);

/// The one volume that a scene names: its grid, its values, and what was assumed.
[[nodiscard]] Expected<Described> describeVolume(const std::filesystem::path &path,
                                                 const imaging::ReadOptions &options);

}  // namespace c3de::app
