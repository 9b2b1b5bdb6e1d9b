// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "app.h"
#include "c3de/core/expected.h"
#include "c3de/imaging/reading.h"

namespace c3de::app {

/// Description of one file, as display text and as JSON.
struct Described {
  std::string text;
  nlohmann::ordered_json json;
};

/// Describes the contents of an image file or a folder of images. For a folder with several series it lists them until
/// one is chosen.
/// @param options       series and time point
/// @param patientNames  whether the names of patients are shown
[[nodiscard]] Expected<Described> describeImage(const std::filesystem::path &path, const imaging::ReadOptions &options,
                                                bool patientNames);

/// The single volume that a scene names: its grid, its values, and the assumptions made.
[[nodiscard]] Expected<Described> describeVolume(const std::filesystem::path &path,
                                                 const imaging::ReadOptions &options);

}  // namespace c3de::app
