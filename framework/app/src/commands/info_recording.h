// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "c3de/core/expected.h"
#include "commands/info_image.h"

namespace c3de::app {

/// What a recording begins with, what happened in it, and whether it is complete.
[[nodiscard]] Expected<Described> describeRecording(const std::filesystem::path &file);

}  // namespace c3de::app
